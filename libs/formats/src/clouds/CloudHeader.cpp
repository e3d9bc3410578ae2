// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/CloudHeader.h>
#include <dyslam/formats/TextFile.h>

#include <cstddef>

namespace dyslam
{
namespace
{
struct NumberNames
{
  const char* pcd_size;
  const char* pcd_type;
  const char* ply;
};

NumberNames namesOf(CloudFieldType type)
{
  switch (type)
  {
    case CloudFieldType::float64:
      return {"8", "F", "double"};
    case CloudFieldType::uint8:
      return {"1", "U", "uchar"};
    case CloudFieldType::float32:
      break;
  }
  return {"4", "F", "float"};
}

/** Fills the digits that the number of points does not need. \param times that it is written */
std::string filler(const CloudHeader& header, std::size_t times)
{
  constexpr std::size_t most_digits = 20;
  return header.has_fixed_length
             ? " " + std::string(times * (most_digits - std::to_string(header.points).size()), '.')
             : "";
}
}  // namespace

std::string pcdHeader(const CloudHeader& header)
{
  std::string names;
  std::string sizes;
  std::string types;
  std::string counts;
  for (const CloudHeaderField& field : header.fields)
  {
    const NumberNames number = namesOf(field.type);
    names += " " + field.name;
    sizes += std::string(" ") + number.pcd_size;
    types += std::string(" ") + number.pcd_type;
    counts += " 1";
  }
  std::string viewpoint;
  for (const double coordinate : header.viewpoint)
  {
    viewpoint += ' ';
    appendNumber(viewpoint, coordinate, 15);
  }
  const std::string points = std::to_string(header.points);
  return "# .PCD v0.7 - Point Cloud Data file format" + filler(header, 2) +
         "\nVERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" +
         counts + "\nWIDTH " + points + "\nHEIGHT 1\nVIEWPOINT" + viewpoint + " 1 0 0 0\nPOINTS " +
         points + "\nDATA binary\n";
}

std::string plyHeader(const CloudHeader& header)
{
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  const std::string comment = header.comment + filler(header, 1);
  if (!comment.empty())
  {
    text += "comment " + comment + "\n";
  }
  text += "element vertex " + std::to_string(header.points) + "\n";
  for (const CloudHeaderField& field : header.fields)
  {
    text += std::string("property ") + namesOf(field.type).ply + " " + field.name + "\n";
  }
  return text + "end_header\n";
}
}  // namespace dyslam
