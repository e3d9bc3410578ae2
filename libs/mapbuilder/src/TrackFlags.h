// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

namespace dyslam
{
/** The two files of a run's tracks with the same name, `tracks.txt` and `tracks.csv`. */
struct TrackFiles
{
  /** \param given either of them. \throws UserError for a .csv without the .txt, since its boxes
   * are not in the frame of the lidar. */
  explicit TrackFiles(const std::string& given);

  std::string boxes;
  std::string table;  //!< path of tracks.csv; empty if it does not exist
};

/** Whether an object is dynamic in any scan of the table, by id. \param needed false: the result is
 * empty for a table without the columns `id` and `dynamic`, which is not of a run \throws UserError
 * "file:line: what" for damaged lines. */
[[nodiscard]] std::map<int, bool> dynamicTracks(const std::string& table, bool needed);
}  // namespace dyslam
