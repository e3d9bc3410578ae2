// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace dyslam
{
/** Writes a file under a temporary name by `write` and renames it once whole. \throws UserError. */
void writeFile(const std::string& path, const std::function<void(std::ostream&)>& write);
/** Gives a file written under `temporary` its name. \throws UserError. */
void renameWritten(const std::string& temporary, const std::string& path);
}  // namespace dyslam
