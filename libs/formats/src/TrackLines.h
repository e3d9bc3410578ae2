// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TextFile.h>

#include <cstddef>
#include <string>

namespace dyslam
{
/** Number of the scan in the first column of a line. \throws UserError for one that no recording
 * has: what counts the scans would overflow or run out of memory. */
[[nodiscard]] int frameFrom(const TextFile& file);
/** The columns that KITTI's tracking labels and our tracks.txt have in common: all but the id and
 * the box. \param box_columns what columns 10 to 16 hold, for the message. \throws UserError unless
 * there are 17 columns, or 18 with the score. */
[[nodiscard]] LabelledBox readTrackLine(const TextFile& file, const char* box_columns);
/** A box in KITTI's camera frame from seven columns, `first` being the first one: height width
 * length x y z ry [m, rad]. \throws UserError "file:line: what". */
[[nodiscard]] CameraBox cameraBoxFrom(const TextFile& file, std::size_t first);

/** The type of an object as one word of a track line, whose columns are separated by blanks. */
[[nodiscard]] std::string typeWord(const LabelledBox& box);
}  // namespace dyslam
