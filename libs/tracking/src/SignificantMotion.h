// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/tracking/PolynomialTrajectory.h>

#include <deque>

namespace dyslam
{
using PositionHistory = std::deque<TimedPosition>;

/** Significance test of a straight motion: whether the slope of a line fitted to the last
 * observations is large compared with its standard deviation. Occlusion boundaries move to and fro
 * instead. */
[[nodiscard]] bool hasSignificantMotion(const PositionHistory& history);
}  // namespace dyslam
