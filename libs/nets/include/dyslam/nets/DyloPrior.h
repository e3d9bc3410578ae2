// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

namespace dyslam
{
/** Gaussian motion prior. */
struct DyloPrior
{
  Pose T_reference_current = Pose::Identity();
  Matrix6 information = Matrix6::Zero();  //!< matrix of log(T_prior^-1 T), [translation, rotation]
  double points_per_measurement = 24;     //!< sampled points per independent measurement
};

/** Factor that scales a normal matrix for weights that sum to 1 to the information of the points:
 * effective_points / points_per_measurement / variance [1/m^2].
 * \param rmse weighted RMS residual [m] \param effective_points 1 / sum of squared weights */
[[nodiscard]] double measurementPrecision(double rmse,
                                          double effective_points,
                                          double points_per_measurement);

/** MAP step: fuses the Gauss-Newton `step` of the points with the prior. Steps are perturbations on
 * the left of the motion `T`. \param measured information of `step` from the points alone */
[[nodiscard]] Vector6 fuseWithPrior(const DyloPrior& prior,
                                    const Pose& T,
                                    const Vector6& step,
                                    const Matrix6& measured);
}  // namespace dyslam
