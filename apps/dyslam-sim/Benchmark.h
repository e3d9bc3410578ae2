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

/** The standing benchmark set: fixed worlds, seeds and lengths. Output paths are
 * `dir/<name>.rawlog`.
 *
 * urban_loop: 64 beams, more than 1.5 km of streets; campus_loop: 16 beams on a robot;
 * highway_dense: 64 beams in dense fast traffic; jam: 64 beams in stop-and-go traffic. Each has two
 * versions: `_traffic`, and `_empty` without moving objects.
 * \param only name of a single recording, or empty for all \throws UserError for an unknown name.
 */
[[nodiscard]] std::vector<NamedRecording> benchmarkSet(const std::string& dir,
                                                       const std::string& only);
}  // namespace dyslam::sim
