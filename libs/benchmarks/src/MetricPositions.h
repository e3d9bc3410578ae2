// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/NoteSink.h>
#include <dyslam/core/Trajectory.h>

#include <string>

namespace dyslam
{
/** Positions in metres: of those on the earth, east, north and up from the first. \param note
 * called if times were converted to UTC \throws UserError. */
[[nodiscard]] Trajectory readMetricPositions(const std::string& path, const NoteSink& note);
}  // namespace dyslam
