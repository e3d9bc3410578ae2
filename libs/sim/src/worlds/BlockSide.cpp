// SPDX-License-Identifier: BSD-3-Clause
#include "BlockSide.h"

#include <algorithm>
#include <cmath>

namespace dyslam::sim
{
Eigen::Affine3f houseFrame(
    const StreetGrid& grid, const Side& side, double s, double front, double width, double depth)
{
  using P = Eigen::Vector2d;
  // The facade's left corner as seen from the street is at the greater s.
  const P corner_local = side.at(s, front);
  const P middle = side.at(s + 0.5 * width, front + 0.5 * depth);
  const P d = grid.toWorld(middle + 0.5 * side.along) - grid.toWorld(middle - 0.5 * side.along);
  double yaw = std::atan2(d.y(), d.x());
  // y points inwards if the block is on the left of x.
  const double cross = side.along.x() * side.inward.y() - side.along.y() * side.inward.x();
  P corner = corner_local;
  if (cross < 0)
  {
    yaw += 3.14159265;
    corner = side.at(s + width, front);
  }
  const P w = grid.toWorld(corner);
  // The house stands at the lowest ground height of its corners.
  double z = 1e9;
  for (const double a : {0.0, width})
  {
    for (const double b : {0.0, depth})
    {
      z = std::min(z, grid.heightLocal(side.at(s + a, front + b)));
    }
  }
  Eigen::Affine3f transform = Eigen::Affine3f::Identity();
  transform.translate(
      Eigen::Vector3d(w.x(), w.y(), std::max(z, grid.heightLocal(corner_local) - 0.3))
          .cast<float>());
  transform.rotate(Eigen::AngleAxisf(static_cast<float>(yaw), Eigen::Vector3f::UnitZ()));
  return transform;
}
}  // namespace dyslam::sim
