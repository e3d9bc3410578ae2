// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionAccumulator.h>

#include <string>
#include <vector>

namespace dyslam
{
/** `motions.csv` of a run: the odometry's covariance of each motion between scans.
 *
 * A row: `stamp,keyframe`, the upper triangle of the motion's covariance row by row (`c00` to
 * `c55`, 21 numbers) and that of the pose noise (`n00` to `n55`). Tangents are [translation,
 * rotation] in m and rad; the motion takes points of the scan to the frame of the scan before.
 */
[[nodiscard]] std::string motionFileHeader();
/** A row of `motions.csv` with its line feed; seven significant digits. */
[[nodiscard]] std::string motionFileRow(const MotionCovariance& motion);
/** Reads `motions.csv`. \throws UserError "file:line: what" for any deviation from the format. */
[[nodiscard]] std::vector<MotionCovariance> readMotionFile(const std::string& path);
}  // namespace dyslam
