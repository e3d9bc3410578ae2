// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <cstddef>
#include <map>
#include <vector>

namespace dyslam
{
/** Box of a track at one scan, in a fixed frame. */
struct TrackBox
{
  std::size_t scan = 0;  //!< number of the scan
  int track = -1;        //!< id of the track
  Box box;
};

/** Finds tracks of the same object: two objects cannot be at the same place. One object has two
 * tracks if its detections alternate between them, or if parts of a vehicle are detected
 * separately.
 *
 * Two tracks are merged if, in at least `least_share` of the scans that have both, their footprints
 * share more than `overlap` of the smaller one. Merging is transitive.
 *
 * \param boxes in any order, at most one per track and scan
 * \param overlap in (0, 1]; at 1 no tracks are merged
 * \return for the id of each merged track the smallest id of the tracks it is merged with; other
 * tracks are not contained */
[[nodiscard]] std::map<int, int> findMergedTracks(std::vector<TrackBox> boxes,
                                                  double overlap,
                                                  double least_share = 0.6);
}  // namespace dyslam
