// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
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

  /** Key of each square and the height of its third lowest return (the highest of fewer) [m]. The
   * detector, which knows the ground from one scan alone, takes the lowest of fewer than 6. */
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

/** Heights of points over the ground [m]. It is known from several scans, so that it is also known
 * below objects. The ground of a square of 2 m is at most 0.3 m above the median of the squares
 * around it, so that a roof is no ground. \param points odometry frame [m] */
[[nodiscard]] std::vector<float> heightsOverGround(const std::vector<const LowestReturns*>& scans,
                                                   const std::vector<Eigen::Vector3f>& points);

/** Heights of points over the ground in the squares of 0.5 m around them, where three scans know
 * it: on slopes and kerbs that is higher than in the large squares [m]. \param points odometry
 * frame [m] \param heights by heightsOverGround(), one per point, the most that they are [m] */
[[nodiscard]] std::vector<float> fineHeightsOverGround(
    const std::vector<const LowestReturns*>& scans,
    const std::vector<Eigen::Vector3f>& points,
    const std::vector<float>& heights);
}  // namespace dyslam
