// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <string>

namespace dyslam
{
/** Opens a file for reading; tells folders and missing files apart.
 * \param advice what the user may do instead, for the message. \throws UserError. */
[[nodiscard]] std::ifstream openBinary(const std::string& path, const std::string& advice = "");
/** The whole of a file. \throws UserError. */
[[nodiscard]] std::string readWhole(const std::string& path, const std::string& advice = "");
/** Makes a folder and its parents, if it is not there. \throws UserError. */
void makeFolder(const std::string& path, const std::string& advice = "");
}  // namespace dyslam
