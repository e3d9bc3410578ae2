// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/formats/FieldConventions.h>

#include <string>

namespace dyslam
{
/** The vertices of a PLY file: ascii, little and big endian; lists are skipped.
 * \throws UserError. */
[[nodiscard]] Scan readPly(const std::string& path, FieldConventions& conventions);
}  // namespace dyslam
