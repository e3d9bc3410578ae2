// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Printable.h>
#include <dyslam/core/Trajectory.h>

#include <string>

namespace dyslam
{
/** A number for messages: 0.01 instead of 0.010000. */
inline std::string shortNumber(double value)
{
  return formatted("%g", value);
}

/** A range of times for messages: "1600000000.000 to 1600000010.000 s". */
inline std::string timesFrom(double first, double last)
{
  return formatted("%.3f to %.3f s", first, last);
}

/** Range of the times of a trajectory, for messages. \pre the trajectory has poses */
inline std::string timesOf(const Trajectory& trajectory)
{
  return timesFrom(trajectory[0].stamp, trajectory[trajectory.size() - 1].stamp);
}
}  // namespace dyslam
