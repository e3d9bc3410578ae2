// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace dyslam
{
/** Folder for the externally stored clouds of a rawlog that is written: `<name>_Images` beside the
 * rawlog. */
[[nodiscard]] std::string externalStorageFolder(const std::string& rawlog);

/** Folder of the externally stored files of a rawlog, by MRPT's names: the first of
 * `<name>_Images`,
 * `_images`, `_img` and `_imgs` that exists. Nothing if none does: external files, if any, are then
 * in the folder of the rawlog. */
[[nodiscard]] std::optional<std::string> externalFolderOf(const std::string& rawlog);
}  // namespace dyslam
