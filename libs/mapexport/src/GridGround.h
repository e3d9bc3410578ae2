// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/StaticMap.h>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace dyslam
{
/** Ground of a map, for its occupancy grid: for each column of 1 m a plane through the lowest
 * points of the columns in a square of 5 m around it.
 *
 * The plane is level unless another slope fits more of the columns, and the majority. Its height is
 * the lower quartile over the columns: robust to ghost points below the road and to walls.
 *
 * Where the ground is hidden, the plane is through the lowest points of what hangs over it: a
 * ceiling above shelves, the upper part of a facade behind a hedge. Thread-safe. */
class GridGround
{
 public:
  /** Steepest plane [m/m]; steeper ground rises above it and becomes an obstacle. */
  static constexpr double max_slope = 0.25;

  /** \param lidars positions of the lidar at the keyframes; none: nothing counts as hanging */
  explicit GridGround(const MapPoints& map, const std::vector<Eigen::Vector3d>& lidars = {});

  /** Height of a point above the ground [m]; NaN for points off the map. */
  [[nodiscard]] double above(const Eigen::Vector3d& p) const;
  /** Whether the ground around a point was seen: the plane there is not above the nearest lidar, or
   * no plane nearby is far below it. False for points off the map. */
  [[nodiscard]] bool isSeenAt(const Eigen::Vector3d& p) const;

 private:
  /** The lowest points of a column. Multipath echoes lie metres below the road, where hardly any
   * voxel is seen from two keyframes. */
  struct Column
  {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    Eigen::Vector3f lowest = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
    Eigen::Vector3f lowest_seen_twice = lowest;

    void add(const Eigen::Vector3f& p, std::uint32_t hits);
    [[nodiscard]] bool isSeenTwice() const;
  };
  /** Plane z = height + slope * (p - centre of the column), map frame. */
  struct Plane
  {
    double height = 0;
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    bool hangs = false;  //!< is not of the ground
  };

  void addColumns(const MapPoints& map);
  void findHanging(const std::vector<Eigen::Vector3d>& lidars);
  /** Height that the plane of a column may have, by the planes nearby [m]. */
  [[nodiscard]] double highestGroundAt(const Column& column) const;
  /** \param reach columns to each side */
  template <typename Use>
  void forEachAround(const Column& column, int reach, const Use& use) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> lowestAround(const Column& column) const;
  [[nodiscard]] Eigen::Vector2d slopeAround(
      const Column& column, const std::vector<std::optional<Eigen::Vector2d>>& slopes) const;

  VoxelHash index_;
  std::vector<Column> columns_;
  std::vector<Plane> planes_;
};
}  // namespace dyslam
