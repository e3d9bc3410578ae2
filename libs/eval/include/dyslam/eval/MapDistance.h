// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace dyslam
{
/** Distances of the points of a cloud from the nearest point of another [m]. All zero without
 * points. */
struct DistanceSummary
{
  /** Limits of `shares` [m]. */
  static constexpr std::array<double, 3> limits{0.1, 0.2, 0.5};

  std::size_t count = 0;           //!< points of the cloud that are finite
  double mean = 0;                 //!< [m]
  double median = 0;               //!< [m]
  double rmse = 0;                 //!< [m]
  double quantile95 = 0;           //!< 95 % of the points are at most that far away [m]
  double max = 0;                  //!< the Hausdorff distance in this direction [m]
  std::array<double, 3> shares{};  //!< of the points that are at most so far away, in [0, 1]
};

/** Cloud-to-cloud distances of two maps in one frame, without labels. */
struct MapDistance
{
  DistanceSummary estimate;   //!< distances of the estimate's points from the reference
  DistanceSummary reference;  //!< distances of the reference's points from the estimate
  /** Distance of each point of the estimate from the reference [m]; NaN for points that are not
   * finite. */
  std::vector<float> of_estimate;
};

/** The result does not depend on the number of threads. Points that are not finite are ignored.
 * \param threads 0: all cores \throws std::invalid_argument if a cloud has no finite point. */
[[nodiscard]] MapDistance mapDistance(const std::vector<Eigen::Vector3f>& reference,
                                      const std::vector<Eigen::Vector3f>& estimate,
                                      int threads = 0);
}  // namespace dyslam
