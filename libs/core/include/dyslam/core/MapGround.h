// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace dyslam
{
/** Ground under the points of a map, z up, in squares of 2 m. The ground is a low quantile of the
 * square's points, or of the squares around if the square lies in a pit: reflections from below the
 * ground do not count. */
class MapGround
{
 public:
  /** \param points [m]; those that are not finite are left out */
  explicit MapGround(const std::vector<Eigen::Vector3f>& points);

  /** Height of a point over the ground of its square [m]. \param p in a square with points
   * \throws std::out_of_range in other squares */
  [[nodiscard]] double heightOver(const Eigen::Vector3f& p) const;
  /** As heightOver(), over the lowest ground of the square and the eight around it: that of a
   * square which walls or ceilings fill is too high. */
  [[nodiscard]] double heightOverLowest(const Eigen::Vector3f& p) const;

 private:
  std::unordered_map<std::int64_t, float> ground_;  //!< by square [m]
  std::unordered_map<std::int64_t, float> lowest_;  //!< of the square and those around it [m]
};
}  // namespace dyslam
