// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace dyslam
{
inline constexpr double radians_per_degree = M_PI / 180;
inline constexpr double degrees_per_radian = 180 / M_PI;

/** `angle` [rad] wrapped to [-pi, pi]. */
[[nodiscard]] inline double wrapAngle(double angle)
{
  return std::remainder(angle, 2 * M_PI);
}
}  // namespace dyslam
