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
  std::string name;          //!< name of its results' folder, unique in the batch
  std::string path;          //!< absolute path
  std::uintmax_t bytes = 0;  //!< size
};

/** The recordings that a user names: all that dyslam reads, folders (rawlogs, bags, captures and
 * KITTI drives within, at any depth), patterns (`drives/2*.rawlog`) and list files (`.txt`: one of
 * all these per line, relative to the list's folder; `#` begins a comment). A folder of point
 * clouds is a recording only if it is named itself.
 *
 * Each recording is taken once, in the order given, and in a folder or pattern in the order of
 * names. The name of a recording is its stem, preceded by as many folders as make it unique:
 * `monday_drive`. \throws UserError for an entry that names no recording. */
[[nodiscard]] std::vector<Recording> listRecordings(const std::vector<std::string>& entries);
}  // namespace dyslam::batch
