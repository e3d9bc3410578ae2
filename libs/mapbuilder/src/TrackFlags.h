// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

namespace dyslam
{
/** The two files of a run's tracks, `tracks.txt` and `tracks.csv` of one name. */
struct TrackFiles
{
  /** \param given either of them. \throws UserError for a .csv without the .txt, since its boxes
   * are not in the frame of the lidar. */
  explicit TrackFiles(const std::string& given);

  std::string boxes;
  std::string table;  //!< empty if it is not there
};

/** By id, whether an object is dynamic in any scan of the table. \param needed false: a table
 * without the columns `id` and `dynamic`, which is not of a run, says nothing \throws UserError
 * "file:line: what" for damaged lines. */
[[nodiscard]] std::map<int, bool> dynamicTracks(const std::string& table, bool needed);
}  // namespace dyslam
