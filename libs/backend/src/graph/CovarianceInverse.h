// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

namespace dyslam
{
/** The information matrix of a covariance: symmetric and positive definite, as a factor needs it.
 *
 * It is the inverse. Where rounding makes that indefinite, because some direction is nearly
 * unknown (along a corridor of exact planes), it is the inverse with the least variances raised to
 * 1e-13 of the largest.
 * \param covariance finite, with a positive eigenvalue */
[[nodiscard]] Matrix6 informationFromCovariance(const Matrix6& covariance);
}  // namespace dyslam
