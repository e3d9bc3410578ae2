// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

namespace dyslam
{
/** What is known of a motion before two scans are matched. */
struct DyloPrior
{
  Pose T_reference_current = Pose::Identity();
  Matrix6 information = Matrix6::Zero();  //!< of log(T_prior^-1 T)
  double correlated_points = 24;          //!< sampled points that count as one measurement
};

/** What the points say, in the prior's measure: factor of a normal matrix of weights that sum to 1.
 * \param rmse weighted, of the residuals [m] \param effective_points 1 / sum of squared weights */
[[nodiscard]] double measuredPrecision(double rmse,
                                       double effective_points,
                                       double correlated_points);

/** The step that points and prior agree on, where the points alone ask for `step`. Steps stand on
 * the left of the motion `T`.
 * \param measured information of the points alone, of `step` */
[[nodiscard]] Vector6 jointStep(const DyloPrior& prior,
                                const Pose& T,
                                const Vector6& step,
                                const Matrix6& measured);
}  // namespace dyslam
