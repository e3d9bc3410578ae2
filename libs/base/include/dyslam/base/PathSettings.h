// SPDX-License-Identifier: BSD-3-Clause
// Settings of a run that are paths of files or folders which it reads.
#pragma once

#include <dyslam/base/Config.h>

#include <string>
#include <vector>

namespace dyslam
{
/** The path from the root, without `.` and `..` where that is the same file or folder. */
[[nodiscard]] std::string absolutePath(const std::string& path);

/** Makes the relative paths among the settings absolute: a run may be resumed in another working
 * directory. Paths of missing files stay as they were
 * given, for the error messages, and so do names of shipped weights. */
void makePathsAbsolute(Config& config);

/** Whether two values of a setting are the same: equal texts, or absolute paths of one file or
 * folder. */
[[nodiscard]] bool isSameSetting(const std::string& section,
                                 const std::string& key,
                                 const std::string& a,
                                 const std::string& b);

/** The files and folders that the settings name, as they are named there; without missing ones and
 * without shipped weights. */
[[nodiscard]] std::vector<std::string> filesNamedIn(const Config& config);

/** Whether an error message is about a file or folder that a setting names: it begins with section
 * and key, "prior_map.file: none.pcd: no such file or folder". */
[[nodiscard]] bool isAboutNamedFile(const std::string& message);
}  // namespace dyslam
