// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
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
 * clouds, which may be maps, is a recording if it is named itself, or if it has several and lies
 * directly in a folder that is named.
 *
 * Each recording is taken once, in the order given, and in a folder or pattern in the order of
 * names. The name of a recording is its stem, of a `recording.rawlog`, as runs write it, that of
 * its folder, preceded by as many folders as make it unique and no name of the batch's own files:
 * `monday_drive`, `monday_index.html`. \param note gets a sentence about each folder of which
 * something is left out, and about each name that is the batch's own \throws UserError for an entry
 * that names no recording. */
[[nodiscard]] std::vector<Recording> listRecordings(
    const std::vector<std::string>& entries,
    const std::function<void(const std::string&)>& note = {});
}  // namespace dyslam::batch
