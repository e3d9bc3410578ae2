// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "SegmentationRun.h"

namespace dyslam
{
/** A traffic scenario in several simulated streets, which are empty except for its actors. */
struct Scenario
{
  std::string name;
  std::vector<SegmentationSet> sets;  //!< one per street
};

/** Parked, stopping, starting, oncoming and crossing cars, a surrounding queue, and pedestrians.
 * \param seed seed of the first street; must not be used in training */
[[nodiscard]] std::vector<Scenario> makeScenarios(std::uint64_t seed, int streets);
}  // namespace dyslam
