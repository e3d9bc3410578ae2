// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace dyslam
{
/** Clock of the times that are computed from the signals of satellites. */
enum class GnssClock
{
  gps,    //!< ahead of UTC by the leap seconds since 1980
  utc,    //!< Coordinated Universal Time
  japan,  //!< nine hours ahead of UTC
};

/** Seconds that a clock is ahead of UTC. \param time of the clock, since 1970 without leap seconds
 * [s] */
[[nodiscard]] int secondsAheadOfUtc(GnssClock clock, double time);

/** UNIX time [s] of a date and a time of day, "2024/05/18" and "12:30:00.5", or of a GPS week and
 * the seconds in it, "2314" and "563400.5", of the clock. \return nothing for other words */
[[nodiscard]] std::optional<double> unixTimeOf(std::string_view date,
                                               std::string_view time,
                                               GnssClock clock);
}  // namespace dyslam
