// SPDX-License-Identifier: BSD-3-Clause
// Settings of a run that are paths: it may be resumed in another working directory.
#pragma once

#include <dyslam/base/Config.h>

#include <string>

namespace dyslam
{
/** The path from the root, without `.` and `..` where that is the same file or folder. */
[[nodiscard]] std::string absolutePath(const std::string& path);

/** Makes the relative paths among the settings absolute. Paths of missing files stay as they were
 * given, for the error messages, and so do names of shipped weights. */
void makePathsAbsolute(Config& config);

/** Whether two values of a setting are the same: equal texts, or absolute paths of one file or
 * folder. */
[[nodiscard]] bool isSameSetting(const std::string& section,
                                 const std::string& key,
                                 const std::string& a,
                                 const std::string& b);
}  // namespace dyslam
