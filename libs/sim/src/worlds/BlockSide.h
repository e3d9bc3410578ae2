// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "StreetGrid.h"

namespace dyslam::sim
{
/** One side of a block of houses, in local coordinates. */
struct Side
{
  Eigen::Vector2d origin;  //!< a corner of the block
  Eigen::Vector2d along;   //!< direction of the street, length 1
  Eigen::Vector2d inward;  //!< direction to the block's interior, length 1
  double length, depth;    //!< extent [m]
  [[nodiscard]] Eigen::Vector2d at(double s, double d) const
  {
    return origin + s * along + d * inward;
  }
};

/** The sides of a block that face a street: south and north, which include the corners, west and
 * east. \param i, j indices of the block, from -1 \param depth of the sides [m] */
[[nodiscard]] std::vector<Side> blockSides(const StreetGrid& grid, int i, int j, double depth);

/** Frame of a house on a side of a block: origin at the left corner of its front, x along the
 * front, y into the block; at the lowest ground height of the house's corners. \param s begin of
 * the house along the side [m] \param front distance of its front from the side [m] \param width,
 * depth of the house [m] \return house to world */
[[nodiscard]] Eigen::Affine3f houseFrame(
    const StreetGrid& grid, const Side& side, double s, double front, double width, double depth);
}  // namespace dyslam::sim
