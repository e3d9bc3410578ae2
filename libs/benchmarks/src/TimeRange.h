// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <cstdio>
#include <string>

namespace dyslam
{
/** A number for messages: 0.01 instead of 0.010000. */
inline std::string shortNumber(double value)
{
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/** A range of times for messages: "1600000000.000 to 1600000010.000 s". */
inline std::string timesFrom(double first, double last)
{
  char text[100];
  std::snprintf(text, sizeof text, "%.3f to %.3f s", first, last);
  return text;
}

/** Range of the times of a trajectory, for messages. \pre the trajectory has poses */
inline std::string timesOf(const Trajectory& trajectory)
{
  return timesFrom(trajectory[0].stamp, trajectory[trajectory.size() - 1].stamp);
}
}  // namespace dyslam
