// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace dyslam
{
/** A file's content. \param advice what to give instead, for the error. \throws UserError. */
[[nodiscard]] std::string readWhole(const std::string& file, const std::string& advice);
}  // namespace dyslam
