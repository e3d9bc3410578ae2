// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/train/ScanFiles.h>

namespace dyslam
{
std::vector<Eigen::Vector3f> readTrainingPoints(const std::string& path, float no_return)
{
  std::vector<Eigen::Vector3f> points = readBin(path).points;
  for (Eigen::Vector3f& p : points)
  {
    if (!isReturn(p))
    {
      p.setConstant(no_return);
    }
  }
  return points;
}
}  // namespace dyslam
