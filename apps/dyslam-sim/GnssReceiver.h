// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/Pose.h>

#include <cstdint>
#include <optional>
#include <random>

namespace dyslam::sim
{
/** Simulates a satellite receiver with a position each second and its antenna 1 m above the
 * vehicle's origin.
 *
 * Its errors are white noise and, as those of the atmosphere and of reflections at buildings, a
 * Gauss-Markov process over a minute; twice as large vertically. */
class GnssReceiver
{
 public:
  explicit GnssReceiver(std::uint64_t seed) : random_(seed) {}

  /** \param stamp of a scan, UNIX time [s]. \return a fix at the stamp if one is due. */
  [[nodiscard]] std::optional<GnssFix> fixAt(double stamp, const Pose& T_map_vehicle);

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::optional<double> last_;                      //!< time of a fix [s]
  Eigen::Vector3d slow_ = Eigen::Vector3d::Zero();  //!< slow errors, in standard deviations
};
}  // namespace dyslam::sim
