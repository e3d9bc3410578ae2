// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MapGround.h>
#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Finds ceilings and the like, such as the lower side of a bridge, in the points of a map: seen
 * from above they hide the floor below them. */
class Ceilings
{
 public:
  /** \param points [m], z up; those that are not finite are left out \param ground of these points
   */
  Ceilings(const std::vector<Eigen::Vector3f>& points, const MapGround& ground);

  /** Whether a point of the map is part of a horizontal layer overhead: most of the nine cells of
   * 1 m around have points at its height, most points over 2.2 m in them are at its height, and
   * there are none right below it. Not so the points of walls, trees and facades.
   * \param p one of the points, finite \param height of `p` over the ground [m] */
  [[nodiscard]] bool contain(const Eigen::Vector3f& p, double height) const;

 private:
  void addColumns(const std::vector<Eigen::Vector3f>& points, const MapGround& ground);
  /** Layers that are ceilings in the cell of a point. */
  [[nodiscard]] std::uint64_t ceilingLayersAt(const Eigen::Vector3f& p) const;

  VoxelHash cells_;    //!< 1 m wide, with points over 2.2 m: places in ceiling_layers_
  VoxelHash columns_;  //!< 0.4 m wide, with points of ceilings: places in column_layers_
  std::vector<std::uint64_t> ceiling_layers_;  //!< layers that are ceilings, a bit each
  std::vector<std::uint64_t> column_layers_;   //!< layers with points, a bit each
};

/** For each point of a map whether it is part of a ceiling, see Ceilings. None is if they are fewer
 * than one in 200: those are awnings, tree tops and the like, which hide little.
 * \param points [m], z up; those that are not finite are no ceilings */
[[nodiscard]] std::vector<bool> ceilingPoints(const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
