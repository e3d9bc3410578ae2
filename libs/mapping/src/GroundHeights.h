// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <utility>
#include <vector>

namespace dyslam
{
class GroundPlanes;
class StateArchive;

/** Lowest returns of one scan in squares of 2 m of the odometry frame. */
class LowestReturns
{
 public:
  LowestReturns() = default;
  /** \param points vehicle frame [m] \param T_odom_vehicle vehicle pose of the scan */
  LowestReturns(const std::vector<Eigen::Vector3f>& points,
                const Eigen::Isometry3f& T_odom_vehicle);

  /** Key of each square of 2 m and the height of its third lowest return (or of its highest, if it
   * has fewer), z of the odometry frame [m]. The detector, which knows the ground from one scan
   * alone, takes the lowest return of squares with fewer than 6. */
  [[nodiscard]] const std::vector<std::pair<std::uint64_t, float>>& heights() const
  {
    return heights_;
  }
  /** Key of each square of 0.5 m and the height of its lowest return, z of the odometry frame [m].
   * Only squares with returns less than 0.5 m above the height of their large square are listed. */
  [[nodiscard]] const std::vector<std::pair<std::uint64_t, float>>& fineHeights() const
  {
    return fine_;
  }
  void exchangeState(StateArchive& archive);

 private:
  std::vector<std::pair<std::uint64_t, float>> heights_;
  std::vector<std::pair<std::uint64_t, float>> fine_;
};

/** Heights of points over the ground, one per point [m]. The ground comes from several scans, so
 * that it is also known below objects. The ground of a square of 2 m is at most 0.3 m above the
 * median of the squares around it, so that a roof is no ground. \param points odometry frame [m]
 * \param planes upper limits of the ground */
[[nodiscard]] std::vector<float> heightsOverGround(const std::vector<const LowestReturns*>& scans,
                                                   const std::vector<Eigen::Vector3f>& points,
                                                   const GroundPlanes& planes);

/** Heights of points over the ground in the squares of 0.5 m around them [m]. Where three scans
 * have returns in such a square, its ground is used if it is higher than that of the large square,
 * as on slopes and kerbs. \param points odometry frame [m] \param heights results of
 * heightsOverGround(), one per point; upper limits of the new heights [m] */
[[nodiscard]] std::vector<float> fineHeightsOverGround(
    const std::vector<const LowestReturns*>& scans,
    const std::vector<Eigen::Vector3f>& points,
    const std::vector<float>& heights);
}  // namespace dyslam
