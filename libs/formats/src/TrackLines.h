// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/formats/TextFile.h>

namespace dyslam
{
/** What KITTI's tracking labels and our tracks.txt have in the same columns of a line: all but the
 * id and the box. \param box_columns what columns 10 to 16 hold, for the message. \throws UserError
 * unless there are 17 columns, or 18 with the score. */
[[nodiscard]] LabelledBox readTrackLine(const TextFile& file, const char* box_columns);
}  // namespace dyslam
