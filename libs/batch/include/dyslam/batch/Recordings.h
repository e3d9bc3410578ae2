// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam::batch
{
/** A recording of a batch. */
struct Recording
{
  std::string name;  //!< of its results' folder, unlike any other of the batch
  std::string path;  //!< absolute
  std::uintmax_t bytes = 0;
};

/** The recordings that a user names: all that dyslam reads, folders (rawlogs, bags, captures and
 * KITTI drives within, at any depth), patterns (`drives/2*.rawlog`) and list files (`.txt`: one of
 * all these per line, relative to the list's folder; `#` begins a comment). A folder of point
 * clouds is a recording only if it is named itself.
 *
 * Each is taken once, in the order given, those of a folder or pattern by name. Names are the stem,
 * with as many folders before it as make it unique: `monday_drive`.
 * \throws UserError for an entry that names no recording. */
[[nodiscard]] std::vector<Recording> listRecordings(const std::vector<std::string>& entries);
}  // namespace dyslam::batch
