// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Georeference.h>

#include <string>

namespace dyslam
{
/** Writes `georeference.ini`: where a map is on the earth, with all digits.
 * \throws UserError if the disk is full. */
void writeGeoreference(const Georeference& georeference, const std::string& path);
/** \throws UserError naming the key that is missing or no number. */
[[nodiscard]] Georeference readGeoreference(const std::string& path);
}  // namespace dyslam
