// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace dyslam
{
/** Opens a file for reading.
 * \param advice what the user may do instead, appended to the error message
 * \throws UserError, with different messages for a folder and for a missing file. */
[[nodiscard]] std::ifstream openBinary(const std::string& path, const std::string& advice = "");
/** To be called after a loop that reads a file. \throws UserError if the loop ended by an error of
 * the disk or the network instead of at the end of the file. */
void requireReadable(const std::istream& file, const std::string& path);
/** Content of a file. \throws UserError if it can't be opened or read to its end. */
[[nodiscard]] std::string readWhole(const std::string& path, const std::string& advice = "");
/** The last part of a path: "run" for "out/run", "out/run/" and, within that folder, ".". */
[[nodiscard]] std::string nameOfFile(const std::string& path);
/** Whether two paths name the same file or folder, with links followed; neither has to exist. */
[[nodiscard]] bool isSamePath(const std::string& a, const std::string& b);
/** Whether a path is `folder` or inside it, with links followed; neither has to exist. */
[[nodiscard]] bool isWithin(const std::string& path, const std::string& folder);
/** Creates a folder and its parents, unless it exists. \throws UserError. */
void makeFolder(const std::string& path, const std::string& advice = "");

/** Whether a path is a folder; false also if the file system reports an error. */
[[nodiscard]] bool isFolder(const std::filesystem::path& path);
/** The files and folders in a folder, by name. \throws UserError if it cannot be read. */
[[nodiscard]] std::vector<std::filesystem::directory_entry> entriesOf(
    const std::filesystem::path& folder);
/** Files and folders in a folder, by name; none if it doesn't exist or can't be read. */
[[nodiscard]] std::vector<std::filesystem::directory_entry> entriesIfReadable(
    const std::filesystem::path& folder);
/** Names of the folders in a folder, sorted. \throws UserError if it cannot be read. */
[[nodiscard]] std::vector<std::string> foldersIn(const std::filesystem::path& folder);
}  // namespace dyslam
