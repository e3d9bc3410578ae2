// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <string>

namespace dyslam
{
/** Opens a file for reading; tells folders and missing files apart.
 * \param advice what the user may do instead, for the message. \throws UserError. */
[[nodiscard]] std::ifstream openBinary(const std::string& path, const std::string& advice = "");
/** For the end of a loop that reads: \throws UserError if it was not the end of the file that ended
 * it but an error of the disk or the network. */
void requireReadable(const std::istream& file, const std::string& path);
/** The whole of a file. \throws UserError, also for errors while it is read. */
[[nodiscard]] std::string readWhole(const std::string& path, const std::string& advice = "");
/** Makes a folder and its parents, if it is not there. \throws UserError. */
void makeFolder(const std::string& path, const std::string& advice = "");
}  // namespace dyslam
