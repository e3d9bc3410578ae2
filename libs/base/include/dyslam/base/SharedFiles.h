// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** A file given by the user: the path itself if there is such a file, else the shared one in
 * `folder` ("kitti64.ini" and "kitti64" find config_files/kitti64.ini).
 *
 * Shared files are looked for in $DYSLAM_SHARE, then, for a program of the build folder, in the
 * source tree; for any other in share/dyslam beside the program's folder (an installed tree), then
 * in the prefix that the library was configured to be installed in.
 * \param field the setting that names the file, for the message; empty for none
 * \param program as of Config::requireFor(): inis of others are not listed in the message; empty:
 * all are
 * \throws UserError naming the shared files of that kind and, for the weights for non-commercial
 * use, their Debian package; or if $DYSLAM_SHARE is no folder. */
[[nodiscard]] std::string findGivenOrShared(const std::string& path,
                                            const std::string& folder,
                                            const std::string& extension,
                                            const std::string& field = "",
                                            const std::string& program = "");

/** For a name with which findGivenOrShared() finds a shared file, while the working folder has a
 * folder of that name or a file with the extension: which file is used, and how to give the other
 * one, as a sentence; empty otherwise. \param field the setting that names the file */
[[nodiscard]] std::string sharedInsteadOf(const std::string& path,
                                          const std::string& folder,
                                          const std::string& extension,
                                          const std::string& field);

/** Paths of all shared files of a folder, by name; of files with the same name, the one that
 * findGivenOrShared() finds. \throws UserError if $DYSLAM_SHARE is no folder. */
[[nodiscard]] std::vector<std::string> sharedFiles(const std::string& folder,
                                                   const std::string& extension);

/** The folders in which shared files are looked for, for a message: "/a/share/dyslam, /b". */
[[nodiscard]] std::string searchedFolders();
}  // namespace dyslam
