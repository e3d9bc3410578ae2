// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapping/MovingInMap.h>

#include "InBox.h"

namespace dyslam
{
std::vector<bool> movingInMap(const Frame& frame, const StaticMapOptions& options)
{
  std::vector<bool> moving = frame.moving;
  moving.resize(frame.cloud.size(), false);
  for (const auto& object : frame.objects)
  {
    if (!object.dynamic)
    {
      continue;
    }
    // The box stands on the ground: its lower side must not cut the road out of the map.
    Box box = object.box;
    constexpr double over_ground = 0.25;
    box.center.z() += 0.5 * over_ground;
    box.size.z() -= over_ground;
    const double reach = 0.5 * box.size.norm() + 2 * options.box_margin;
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(options.box_margin);
    const Eigen::Vector3d center = frame.T_odom_vehicle.inverse() * box.center;
    for (std::size_t i = 0; i < moving.size(); ++i)
    {
      const Eigen::Vector3d p = frame.cloud.points[i].cast<double>();
      moving[i] = moving[i] || ((p - center).squaredNorm() < reach * reach &&
                                isInBox(box, frame.T_odom_vehicle * p, margin));
    }
  }
  return moving;
}
}  // namespace dyslam
