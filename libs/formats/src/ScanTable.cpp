// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/formats/ScanTable.h>

#include <algorithm>
#include <fstream>
#include <vector>

namespace dyslam
{
namespace
{
/** Fields of a line; those in quotes may have commas. */
std::vector<std::string> fieldsOf(const std::string& line)
{
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line)
  {
    quoted = c == '"' ? !quoted : quoted;
    if (c == ',' && !quoted)
    {
      fields.emplace_back();
    }
    else if (c != '"' && c != '\r')
    {
      fields.back().push_back(c);
    }
  }
  return fields;
}
}  // namespace

std::set<std::size_t> unregisteredScans(const std::string& path)
{
  std::ifstream file = openBinary(path);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> header = fieldsOf(line);
  const auto column = [&](const char* name)
  {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end())
    {
      throw UserError(path + ": has no column '" + name + "'; is it the scans.csv of a run?");
    }
    return static_cast<std::size_t>(found - header.begin());
  };
  const std::size_t frame = column("frame");
  const std::size_t registered = column("registered");
  std::set<std::size_t> scans;
  while (std::getline(file, line))
  {
    const std::vector<std::string> fields = fieldsOf(line);
    if (fields.size() == header.size() && fields[registered] == "0")
    {
      scans.insert(std::stoul(fields[frame]));
    }
  }
  return scans;
}
}  // namespace dyslam
