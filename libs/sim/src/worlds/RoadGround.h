// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "Ground.h"
#include "Path.h"

namespace dyslam::sim
{
/** Ground along one closed road. Local coordinates: u along its centre line, v to the left of it.
 */
class RoadGround : public Ground
{
 public:
  /** \param path centre line of the road \param edge of the road, distance from the centre line [m]
   * \param tunnel without ditches and embankments */
  RoadGround(std::uint64_t seed, Path path, double edge, bool tunnel);

  [[nodiscard]] Eigen::Vector2d toWorld(const Eigen::Vector2d& local) const override;
  [[nodiscard]] Eigen::Vector2d toLocal(const Eigen::Vector2d& world) const override;
  [[nodiscard]] double heightLocal(const Eigen::Vector2d& local) const override;

 private:
  /** Height of the cross-section above the terrain [m]. */
  [[nodiscard]] double profile(double s, double d) const;
  static long key(const Eigen::Vector2d& p);
  /** Index of the nearest point of the centre line. */
  [[nodiscard]] int nearest(const Eigen::Vector2d& world) const;

  Terrain terrain_;
  Path path_;
  double edge_;
  bool tunnel_;
  std::array<double, 4> phase_{};
  std::vector<double> s_;                               // arc length of each point of path_ [m]
  std::unordered_map<long, std::vector<int>> buckets_;  // points of path_ by squares of 40 m
};
}  // namespace dyslam::sim
