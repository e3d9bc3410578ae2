// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxInterior.h>
#include <dyslam/mapping/MovingInMap.h>

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
    constexpr double over_ground = 0.25;  // of the lower side before it is widened [m]
    const Box& box = object.box;
    const auto inside = BoxInterior<double>(box, Eigen::Vector3d::Constant(options.box_margin))
                            .aboveGround(over_ground - options.box_margin);
    const double reach = 0.5 * box.size.norm() + 2 * options.box_margin;
    const Eigen::Vector3d centre = frame.T_odom_vehicle.inverse() * box.centre;
    for (std::size_t i = 0; i < moving.size(); ++i)
    {
      const Eigen::Vector3d p = frame.cloud.points[i].cast<double>();
      moving[i] = moving[i] || ((p - centre).squaredNorm() < reach * reach &&
                                inside.contains(frame.T_odom_vehicle * p));
    }
  }
  return moving;
}
}  // namespace dyslam
