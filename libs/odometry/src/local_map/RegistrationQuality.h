// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/odometry/RefineOptions.h>

#include <string>

#include "ScanToMap.h"

namespace dyslam
{
/** What is wrong with a registration, as a sentence; empty if it may be accepted. Values are
 * rounded down, so that none reads as its limit. */
[[nodiscard]] std::string failureReason(const ScanToMapResult& found, const RefineOptions& options);
/** Whether some direction of motion is constrained less than by a standard deviation of `sigma`
 * [m], or of the angle that moves a point 10 m away by as much. \param information of [translation,
 * rotation] */
[[nodiscard]] bool isDegenerate(const Matrix6& information, double sigma);
/** Distance of two poses [m]: the translation, plus the rotation as the translation that it causes
 * of a point 10 m away. */
[[nodiscard]] double poseDistance(const Pose& a, const Pose& b);
}  // namespace dyslam
