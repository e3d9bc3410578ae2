// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace dyslam
{
/** Opens a file for reading; tells folders and missing files apart.
 * \param advice what the user may do instead, for the message. \throws UserError. */
[[nodiscard]] std::ifstream openBinary(const std::string& path, const std::string& advice = "");
/** Call it after a loop that reads: \throws UserError if the loop ended by an error of the disk or
 * the network, not at the end of the file. */
void requireReadable(const std::istream& file, const std::string& path);
/** The whole of a file. \throws UserError, also for errors while it is read. */
[[nodiscard]] std::string readWhole(const std::string& path, const std::string& advice = "");
/** The last part of a path: "run" for "out/run", "out/run/" and, within that folder, ".". */
[[nodiscard]] std::string nameOfFile(const std::string& path);
/** Whether two paths are of the same file or folder, with links followed; there need be none yet.
 */
[[nodiscard]] bool isSamePath(const std::string& a, const std::string& b);
/** Whether a path is that folder or lies in it, with links followed; there need be neither yet. */
[[nodiscard]] bool isWithin(const std::string& path, const std::string& folder);
/** Makes a folder and its parents, if it is not there. \throws UserError. */
void makeFolder(const std::string& path, const std::string& advice = "");

/** Whether a path is a folder; false also if nobody can tell. */
[[nodiscard]] bool isFolder(const std::filesystem::path& path);
/** The files and folders in a folder, by name. \throws UserError if it cannot be read. */
[[nodiscard]] std::vector<std::filesystem::directory_entry> entriesOf(
    const std::filesystem::path& folder);
/** The same; none if the folder is not there or cannot be read. */
[[nodiscard]] std::vector<std::filesystem::directory_entry> entriesIfReadable(
    const std::filesystem::path& folder);
/** Names of the folders in a folder, sorted. \throws UserError if it cannot be read. */
[[nodiscard]] std::vector<std::string> foldersIn(const std::filesystem::path& folder);
}  // namespace dyslam
