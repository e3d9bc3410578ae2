// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/sim/Simulator.h>

#include <vector>

#include "SweepScene.h"

namespace dyslam::sim
{
/** Returns from one body in a sweep. */
struct BodyReturns
{
  std::size_t points = 0;  //!< number of returns
  double time = 0;         //!< sum of the returns' times relative to the stamp [s]
};

/** Casts all rays of a sweep and converts the hits to returns with ground truth. Fills the
 * per-point arrays of `scan`. \return the returns per body. Same bytes for any size of the pool. */
[[nodiscard]] std::vector<BodyReturns> castSweep(const SensorModel& sensor,
                                                 const SweepScene& scene,
                                                 ThreadPool& pool,
                                                 SimulatedScan& scan);
}  // namespace dyslam::sim
