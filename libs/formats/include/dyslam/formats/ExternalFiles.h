// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace dyslam
{
/** Folder that a rawlog is written with, for clouds in files of their own: `<name>_Images` beside
 * it. */
[[nodiscard]] std::string externalStorageFolder(const std::string& rawlog);

/** The folder of such files beside a rawlog, as MRPT names them: the first of `<name>_Images`,
 * `_images`, `_img` and `_imgs` that is there. Nothing without: then its files, if it has any, are
 * in the folder of the rawlog. */
[[nodiscard]] std::optional<std::string> externalFolderOf(const std::string& rawlog);
}  // namespace dyslam
