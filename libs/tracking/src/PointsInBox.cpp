// SPDX-License-Identifier: BSD-3-Clause
#include "PointsInBox.h"

#include <cmath>

namespace dyslam
{
namespace
{
constexpr float margin = 0.1F;            // margin around the box, except below [m]
constexpr float ground_clearance = 0.1F;  // height above the bottom of the box [m]
}  // namespace

std::vector<std::uint32_t> pointsInside(const Box& box, const std::vector<Eigen::Vector3f>& points)
{
  const Eigen::Vector3f centre = box.center.cast<float>();
  const Eigen::Array3f half = 0.5F * box.size.cast<float>().array() + margin;
  const float bottom = ground_clearance - 0.5F * static_cast<float>(box.size.z());
  const float reach = half.matrix().head<2>().squaredNorm();
  const auto cosine = static_cast<float>(std::cos(box.yaw));
  const auto sine = static_cast<float>(std::sin(box.yaw));
  std::vector<std::uint32_t> inside;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f p = points[i] - centre;
    if (p.head<2>().squaredNorm() < reach && p.z() > bottom && p.z() < half.z() &&
        std::abs(cosine * p.x() + sine * p.y()) < half.x() &&
        std::abs(cosine * p.y() - sine * p.x()) < half.y())
    {
      inside.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return inside;
}
}  // namespace dyslam
