// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/loss_function.h>
#include <dyslam/backend/FactorGraph.h>

#include <memory>

namespace dyslam
{
/** Dynamic covariance scaling (Agarwal et al., ICRA 2013) as a loss: quadratic up to `width`, then
 * approaching a constant. The weight at squared residual s is min(1, 2 w^2 / (w^2 + s))^2. */
[[nodiscard]] std::unique_ptr<ceres::LossFunction> makeDcsLoss(double width);

/** Ceres loss function; null for RobustLoss::none. */
[[nodiscard]] std::unique_ptr<ceres::LossFunction> makeLoss(RobustLoss loss, double width);
}  // namespace dyslam
