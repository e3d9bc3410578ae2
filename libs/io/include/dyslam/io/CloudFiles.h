// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/ScanFiles.h>

#include <string>

namespace dyslam
{
/** Reads `.bin`, `.pcd` or `.ply` by its ending. Of PCD and PLY the fields x y z, `intensity` (or
 * `reflectivity`), `ring` and `time` (or `t`, `timestamp`: seconds, or nanoseconds for whole
 * numbers) are taken. Times since 1970 (above an hour) are counted from the earliest, which becomes
 * the stamp; smaller ones are as in the file, and so are intensities. \throws UserError. */
[[nodiscard]] Scan readCloud(const std::string& path);
}  // namespace dyslam
