// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/report/RunPage.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

namespace dyslam
{
/** Adds final trajectory, odometry and ground truth: the poses of every n-th scan.
 * \param max_scans the ground truth has at most so many poses */
void addTrajectories(const RunPage& page,
                     std::size_t step,
                     std::size_t max_scans,
                     nlohmann::ordered_json& json);

/** Adds errors and drift against the ground truth; without one, of the odometry against the final
 * trajectory. */
void addErrors(const RunPage& page, std::size_t max_scans, nlohmann::ordered_json& json);

/** Longest distance between odometry and final trajectory [m]. */
[[nodiscard]] double largestCorrection(const RunPage& page);

/** Speed at each scan [m/s]: over half a second, more where the scans before and after are farther
 * away; of all scans, since those shown may be seconds apart. */
[[nodiscard]] std::vector<double> speeds(const Trajectory& trajectory);
}  // namespace dyslam
