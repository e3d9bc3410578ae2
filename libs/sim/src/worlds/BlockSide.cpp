// SPDX-License-Identifier: BSD-3-Clause
#include "BlockSide.h"

#include <algorithm>
#include <cmath>

namespace dyslam::sim
{
std::vector<Side> blockSides(const StreetGrid& grid, int i, int j, double depth)
{
  using P = Eigen::Vector2d;
  constexpr double kShortest = 8;  // length of a side between two others [m]
  const auto e = grid.blockInside(i, j);
  const P sw(e[0], e[1]), se(e[2], e[1]), ne(e[2], e[3]), nw(e[0], e[3]);
  const double width = e[2] - e[0], height = e[3] - e[1];
  const int nu = static_cast<int>(grid.along_v.size()), nv = static_cast<int>(grid.along_u.size());
  const bool south = j >= 0, north = j + 1 < nv, west = i >= 0, east = i + 1 < nu;
  std::vector<Side> sides;
  if (south)
  {
    sides.push_back({se, P(-1, 0), P(0, 1), width, depth});
  }
  if (north)
  {
    sides.push_back({nw, P(1, 0), P(0, -1), width, depth});
  }
  const double cut0 = south ? depth + 1 : 0, cut1 = north ? depth + 1 : 0;
  const double rest = height - cut0 - cut1;
  if (west && rest > kShortest)
  {
    sides.push_back({sw + P(0, cut0), P(0, 1), P(1, 0), rest, depth});
  }
  if (east && rest > kShortest)
  {
    sides.push_back({ne - P(0, cut1), P(0, -1), P(-1, 0), rest, depth});
  }
  return sides;
}

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
