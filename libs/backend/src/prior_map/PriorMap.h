// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "loops/KeyframeRegistration.h"

namespace dyslam
{
class StateArchive;

/** Height of the ground within 4 m of a position [m]; nothing if there are too few points.
 * \param points z upwards [m], with about the same density everywhere */
[[nodiscard]] std::optional<double> groundAmong(const std::vector<Eigen::Vector3f>& points,
                                                double x,
                                                double y);

/** Points of a static map in square tiles, of which the surroundings of a place are put together as
 * a registration target. Not thread-safe. */
class PriorMap
{
 public:
  static constexpr double voxel_size = 0.3;  //!< of points() [m]

  /** \param points frame of the map [m], z about vertical \param range of the points that are to be
   * registered [m] */
  PriorMap(const std::vector<Eigen::Vector3f>& points, double range);

  [[nodiscard]] bool empty() const { return points_.empty(); }
  /** The points in voxels of `voxel_size`, frame of the map [m]. */
  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }

  /** The map within `range` of a position, and some metres around it, in the frame of the map.
   * Valid until the next call. */
  [[nodiscard]] RegistrationTarget& around(const Eigen::Vector3d& position);

  void exchangeState(StateArchive& archive);

  /** Height of the ground within 4 m of a position [m]; nothing where the map is empty. */
  [[nodiscard]] std::optional<double> groundHeight(double x, double y) const;

 private:
  struct Tile
  {
    std::int32_t x = 0;
    std::int32_t y = 0;
  };
  [[nodiscard]] static Tile tileOf(double x, double y);
  [[nodiscard]] static std::uint64_t keyOf(const Tile& tile)
  {
    return voxelKey({tile.x, tile.y, 0});
  }
  /** The points of the tiles in a rectangle, row by row. */
  [[nodiscard]] std::vector<Eigen::Vector3f> pointsBetween(const Tile& low, const Tile& high) const;

  double range_;
  std::vector<Eigen::Vector3f> points_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> tiles_;  //!< indices of points_
  std::optional<Eigen::Vector3d> centre_;                                //!< of the last target
  std::optional<RegistrationTarget> target_;  //!< made again after the state was loaded
};
}  // namespace dyslam
