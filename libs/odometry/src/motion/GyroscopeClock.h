// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>

#include "SampledSignal.h"

namespace dyslam
{
class StateArchive;

/** Estimates by how much the stamps of a gyroscope differ from those of the scans.
 *
 * The mean angular velocities between scans are correlated with those of the gyroscope over times
 * that are earlier or later by a lag of up to a second. Not thread-safe.
 */
class GyroscopeClock
{
 public:
  using Rates = std::deque<Sample<Eigen::Vector3d>>;

  /** Adds a rotation that the scans show. \param begin,end stamps of two scans, end after begin [s]
   * \param rate mean angular velocity between them, vehicle frame [rad/s] */
  void add(double begin, double end, const Eigen::Vector3d& rate);

  /** Compares the added rotations that lie at least a second before the last sample; leaves out
   * those without samples from a second before to a second after them.
   * \param rates angular velocities, vehicle frame, ascending by stamp [rad/s]
   * \param max_gap largest time without a sample [s] */
  void compare(const Rates& rates, double max_gap);

  /** Stamps of the gyroscope minus those of the scans, of the same instants: positive if the
   * gyroscope's are late [s]. Nothing unless the vehicle turned enough to tell, and the offset is
   * at least 0.1 s and fits clearly better than smaller ones. */
  [[nodiscard]] std::optional<double> offset() const;

  void exchangeState(StateArchive& archive);

 private:
  static constexpr std::size_t lags = 101;

  struct Rotation
  {
    double begin = 0;  //!< [s]
    double end = 0;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();  //!< [rad/s]
  };
  /** Sums of angular velocities over the compared rotations. */
  struct Sums
  {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0;   //!< of their norms
    double products = 0;  //!< dot products with those by the scans
  };

  /** Sum over the axes of the variance. */
  [[nodiscard]] double varianceOf(const Sums& sums) const;
  /** Share of the variance of the scans' angular velocities that the gyroscope's leave unexplained
   * at each lag, 0 to 1. */
  [[nodiscard]] std::array<double, lags> unexplained() const;

  std::deque<Rotation> waiting_;  //!< for later samples
  std::size_t compared_ = 0;
  Sums of_scans_;
  std::array<Sums, lags> of_gyroscope_;
};
}  // namespace dyslam
