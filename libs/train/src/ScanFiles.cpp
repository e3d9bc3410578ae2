// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Scan.h>
#include <dyslam/train/ScanFiles.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>

namespace dyslam
{
std::vector<Eigen::Vector3f> readBinPoints(const std::string& path)
{
  const std::string bytes = readWhole(path, "check the folder of the training data");
  if (bytes.size() % 16 != 0)
  {
    throw UserError(path + ": " + std::to_string(bytes.size()) +
                    " bytes are no whole number of points of x y z intensity");
  }
  std::vector<Eigen::Vector3f> points(bytes.size() / 16);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    std::memcpy(points[i].data(), bytes.data() + 16 * i, 12);
    if (!isReturn(points[i]))
    {
      points[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  return points;
}

std::vector<std::uint32_t> readLabels(const std::string& path, std::size_t points)
{
  const std::string bytes = readWhole(path, "check the folder of the training data");
  if (bytes.size() != 4 * points)
  {
    throw UserError(path + ": holds " + std::to_string(bytes.size() / 4) + " labels for " +
                    std::to_string(points) + " points");
  }
  std::vector<std::uint32_t> labels(points);
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(labels.data()));
  return labels;
}

std::vector<Pose> readPoses12(const std::string& path)
{
  std::istringstream text(readWhole(path, "check the folder of the training data"));
  std::vector<Pose> poses;
  int number = 0;
  for (std::string line; std::getline(text, line);)
  {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos)
    {
      continue;
    }
    std::istringstream numbers(line);
    Pose pose = Pose::Identity();
    for (int i = 0; i < 12; ++i)
    {
      numbers >> pose.matrix()(i / 4, i % 4);
    }
    if (!numbers || !(numbers >> std::ws).eof())
    {
      throw UserError(path + ": line " + std::to_string(number) + ": 12 numbers a line are needed");
    }
    poses.push_back(orthonormalized(pose));
  }
  return poses;
}

std::vector<std::string> binFiles(const std::string& folder)
{
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
  {
    if (entry.path().extension() == ".bin")
    {
      files.push_back(entry.path().string());
    }
  }
  if (files.empty())
  {
    throw UserError(folder + ": no .bin scans there");
  }
  std::sort(files.begin(), files.end());
  return files;
}
}  // namespace dyslam
