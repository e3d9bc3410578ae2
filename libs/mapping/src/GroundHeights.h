// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/core/VoxelGrid.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Lowest returns of one scan in squares of 2 m of the odometry frame. */
class LowestReturns
{
 public:
  LowestReturns() = default;
  /** \param points vehicle frame [m] \param T_odom_vehicle pose of the vehicle at the scan. */
  LowestReturns(const std::vector<Eigen::Vector3f>& points,
                const Eigen::Isometry3f& T_odom_vehicle);

  /** Key of each square and the height of its third lowest return (the highest of fewer) [m]:
   * multipath echoes lie below the road. The detector, which knows the ground from one scan alone,
   * takes the lowest of fewer than 6. */
  [[nodiscard]] const std::vector<std::pair<std::uint64_t, float>>& heights() const
  {
    return heights_;
  }
  /** The lowest return in each square of 0.5 m, of those less than 0.5 m above that height of its
   * large square. */
  [[nodiscard]] const std::vector<std::pair<std::uint64_t, float>>& fineHeights() const
  {
    return fine_;
  }
  void exchangeState(StateArchive& archive);

 private:
  std::vector<std::pair<std::uint64_t, float>> heights_;
  std::vector<std::pair<std::uint64_t, float>> fine_;
};

/** Height of the ground from several scans, so that it is known below objects, too. */
class GroundHeights
{
 public:
  explicit GroundHeights(const std::vector<const LowestReturns*>& scans);
  /** Heights of points over the ground [m]. The ground of a square is at most 0.3 m above the
   * median of the squares around it, so that a roof is no ground. \param points odometry frame [m]
   */
  [[nodiscard]] std::vector<float> heightsOf(const std::vector<Eigen::Vector3f>& points) const;

  /** Height over the ground in the square of 0.5 m around a point, where it is known: on slopes and
   * kerbs that is higher than in the large one. \param height by heightsOf(), the most that it is
   * [m]
   */
  [[nodiscard]] float fineHeightOf(const Eigen::Vector3f& p, float height) const;

 private:
  /** Ground of a square: its own height, as far as the squares around it allow [m]. */
  [[nodiscard]] float limited(const VoxelCell& square, float own) const;

  VoxelHash index_;
  std::vector<float> height_;  //!< of the squares, without the limit
  VoxelHash fine_index_;
  std::vector<float> fine_height_;
};
}  // namespace dyslam
