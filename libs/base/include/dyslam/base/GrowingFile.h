// SPDX-License-Identifier: BSD-3-Clause
// Files that are read while they are written: the writer holds a lock (flock) on the file until it
// closes it. The system releases the lock of a killed program, so a reader never waits in vain.
#pragma once

#include <string>

namespace dyslam
{
/** Creates a file that grows until its descriptor is closed. An earlier file of the name is
 * replaced, but not for those who still read it, and stays if the new one fails.
 * \return descriptor for writing
 * \throws UserError if the file cannot be created or locked, or another program writes it. */
[[nodiscard]] int createGrowingFile(const std::string& path);

/** Whether a file still grows: someone else holds the lock of createGrowingFile(). */
[[nodiscard]] bool isGrowing(int descriptor);
/** The same by name; false for a file that is missing. */
[[nodiscard]] bool isGrowing(const std::string& path);
}  // namespace dyslam
