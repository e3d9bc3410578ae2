// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Georeference.h>

#include <string>

namespace dyslam
{
/** Writes `georeference.ini`, the pose of a map on the earth, with all digits.
 * \throws UserError if the disk is full. */
void writeGeoreference(const Georeference& georeference, const std::string& path);
/** Reads `georeference.ini`. \throws UserError naming the key that is missing or no number. */
[[nodiscard]] Georeference readGeoreference(const std::string& path);
}  // namespace dyslam
