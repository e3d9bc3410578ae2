// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "SegmentationRun.h"

namespace dyslam
{
/** A situation on the road, in several simulated streets that are empty but for its actors. */
struct Scenario
{
  std::string name;
  std::vector<SegmentationSet> sets;  //!< one per street
};

/** Cars that stand, stop, start, come towards and cross, a queue all around, people.
 * \param seed of the first street; the trainer must never draw it. */
[[nodiscard]] std::vector<Scenario> makeScenarios(std::uint64_t seed, int streets);
}  // namespace dyslam
