// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/tracking/PolynomialTrajectory.h>

#include <deque>

namespace dyslam
{
using PositionHistory = std::deque<TimedPosition>;

/** Significance test of a straight motion: the slope of a line fitted to the last observations
 * contradicts its standard deviation. Occlusion boundaries flicker to and fro instead. */
[[nodiscard]] bool hasSignificantMotion(const PositionHistory& history);
}  // namespace dyslam
