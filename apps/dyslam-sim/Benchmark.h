// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "Recorder.h"

namespace dyslam::sim
{
struct NamedRecording
{
  std::string name;
  Recording recording;
};

/** The fixed benchmark set: fixed worlds, seeds and lengths. Output paths are `dir/<name>.rawlog`.
 *
 * urban_loop: 64 beams, more than 1.5 km of streets; campus_loop: 16 beams on a robot;
 * highway_dense: 64 beams in dense fast traffic; jam: 64 beams in stop-and-go traffic. Each has two
 * versions: `_traffic`, and `_empty` without moving objects.
 */
[[nodiscard]] std::vector<NamedRecording> standingSet(const std::string& dir);

/** Eleven drives, `<split>_00` to `<split>_10`, of the same kinds in both splits (splits.ini) with
 * seeds of that split. \param split "validation" or "test" \throws UserError for another. */
[[nodiscard]] std::vector<NamedRecording> splitSet(const std::string& dir,
                                                   const std::string& split);

/** The one recording of that name. \throws UserError if there is none. */
[[nodiscard]] NamedRecording oneOf(const std::vector<NamedRecording>& set, const std::string& name);
}  // namespace dyslam::sim
