// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/formats/TextFile.h>

namespace dyslam
{
/** The columns that KITTI's tracking labels and our tracks.txt have in common: all but the id and
 * the box. \param box_columns what columns 10 to 16 hold, for the message. \throws UserError unless
 * there are 17 columns, or 18 with the score. */
[[nodiscard]] LabelledBox readTrackLine(const TextFile& file, const char* box_columns);
}  // namespace dyslam
