// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "SignificantMotion.h"

namespace dyslam
{
class StateArchive;

/** White noise of the last four observations relative to `covariance` [m^2], from their third
 * difference, which eliminates smooth motion; 1 is expected for noise of that covariance. Nothing
 * unless the observations are equally spaced in time. */
[[nodiscard]] std::optional<double> whiteNoise(const PositionHistory& history,
                                               const Eigen::Matrix2d& covariance);

/** Running estimate of the ratio of the detections' noise to their covariances. */
class NoiseScale
{
 public:
  void add(double white_noise);
  /** Factor on standard deviations, 1 to 10. Not below 1, since errors that are correlated from
   * scan to scan cancel in differences. */
  [[nodiscard]] double factor() const;

  void exchangeState(StateArchive& archive);

 private:
  static constexpr double prior_weight = 20;
  double sum_ = prior_weight;
  double weight_ = prior_weight;
};
}  // namespace dyslam
