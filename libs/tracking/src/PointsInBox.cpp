// SPDX-License-Identifier: BSD-3-Clause
#include "PointsInBox.h"

#include <dyslam/core/BoxInterior.h>

namespace dyslam
{
namespace
{
constexpr float margin = 0.1F;            // margin around the box, except below [m]
constexpr float ground_clearance = 0.1F;  // height above the bottom of the box [m]
}  // namespace

std::vector<std::uint32_t> pointsInside(const Box& box, const std::vector<Eigen::Vector3f>& points)
{
  const BoxInterior<float> interior =
      BoxInterior<float>(box, Eigen::Vector3f::Constant(margin)).aboveGround(ground_clearance);
  std::vector<std::uint32_t> inside;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (interior.contains(points[i]))
    {
      inside.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return inside;
}
}  // namespace dyslam
