// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/TextFile.h>

namespace dyslam
{
namespace
{
constexpr std::size_t triangle = 21;
constexpr int digits = 7;

void appendTriangle(std::string& text, const Matrix6& M)
{
  for (int i = 0; i < 6; ++i)
  {
    for (int j = i; j < 6; ++j)
    {
      text += ',';
      appendNumber(text, M(i, j), digits);
    }
  }
}

Matrix6 triangleFrom(const std::vector<double>& row, std::size_t at)
{
  Matrix6 M;
  for (int i = 0; i < 6; ++i)
  {
    for (int j = i; j < 6; ++j)
    {
      M(i, j) = M(j, i) = row[at++];
    }
  }
  return M;
}
}  // namespace

std::string motionFileHeader()
{
  std::string header = "stamp,keyframe";
  for (const char kind : {'c', 'n'})
  {
    for (int i = 0; i < 6; ++i)
    {
      for (int j = i; j < 6; ++j)
      {
        header += std::string(",") + kind + std::to_string(i) + std::to_string(j);
      }
    }
  }
  return header + "\n";
}

std::string motionFileRow(const MotionCovariance& motion)
{
  std::string text;
  appendFixed(text, motion.stamp, 9);
  text += motion.is_keyframe ? ",1" : ",0";
  appendTriangle(text, motion.covariance);
  appendTriangle(text, motion.pose_noise);
  return text + "\n";
}

std::vector<MotionCovariance> readMotionFile(const std::string& path)
{
  TextFile file(path, ",\r");
  if (!file.next() || file.fields().front() != "stamp")
  {
    file.fail("the header 'stamp,keyframe,...' is missing");
  }
  std::vector<MotionCovariance> motions;
  while (file.next())
  {
    file.requireFields(2 + 2 * triangle, "stamp, keyframe, and two triangles of 21 numbers");
    const std::vector<double> row = file.numbers();
    motions.push_back({row[0], row[1] != 0, triangleFrom(row, 2), triangleFrom(row, 2 + triangle)});
  }
  return motions;
}
}  // namespace dyslam
