// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Reads tracks from a text file with the columns of KITTI's tracking labels, in the lidar frame.
 *
 * `frame id type truncated occluded alpha left top right bottom height width length x y z yaw
 * [score]`; x y z is the box's centre (half height), yaw the heading about +z from +x. See
 * doc/formats.md. \throws UserError "file:line: what". */
[[nodiscard]] std::vector<LabelledBox> readTracks(const std::string& path);
/** A line of a file of readTracks(). */
[[nodiscard]] std::string trackLine(const LabelledBox& box);
void writeTracks(const std::string& path, const std::vector<LabelledBox>& boxes);
}  // namespace dyslam
