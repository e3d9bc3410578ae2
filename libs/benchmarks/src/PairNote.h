// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/NoteSink.h>
#include <dyslam/eval/Association.h>

#include <algorithm>
#include <string>

namespace dyslam
{
/** Notes if errors cover only a part of the trajectories: fewer than 90 % of the pairs that the
 * shorter one allows, or fewer than half of the estimated poses. \param estimate, reference their
 * files \param tolerance tolerance of the time stamps, as the user gave it [s] */
inline void noteFewPairs(const PosePairs& pairs,
                         const std::string& estimate,
                         const std::string& reference,
                         const std::string& tolerance,
                         const NoteSink& note)
{
  const std::size_t possible = std::min(pairs.reference_size, pairs.estimate_size);
  if (10 * pairs.size() < 9 * possible || 2 * pairs.size() < pairs.estimate_size)
  {
    note(estimate + ": only " + std::to_string(pairs.size()) + " of " +
         counted(pairs.estimate_size, "pose") + " have one of " +
         std::to_string(pairs.reference_size) + " in " + reference + " within " + tolerance + " s" +
         (pairs.positions_only ? "" : "; RPE is between the poses that have"));
  }
}
}  // namespace dyslam
