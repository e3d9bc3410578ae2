// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/formats/FieldConventions.h>

#include <string>

namespace dyslam
{
/** PCD 0.6 and 0.7: ascii, binary and binary_compressed. \throws UserError. */
[[nodiscard]] Scan readPcd(const std::string& path, FieldConventions& conventions);
}  // namespace dyslam
