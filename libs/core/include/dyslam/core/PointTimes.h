// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <vector>

namespace dyslam
{
/** Whether a point can have been measured at this time after its scan's stamp [s]: within a minute;
 * false for NaN. */
[[nodiscard]] inline bool isPossibleTime(float time)
{
  return std::abs(time) < 60.0F;
}

/** Times of the first and the last point of a scan [s]. */
struct TimeExtent
{
  float first = 0;
  float last = 0;

  [[nodiscard]] double duration() const { return static_cast<double>(last - first); }
};

/** Extent of the possible ones of Scan::time; nothing if there are none. */
[[nodiscard]] std::optional<TimeExtent> timeExtent(const std::vector<float>& times);
}  // namespace dyslam
