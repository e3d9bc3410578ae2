// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "Arguments.h"
#include "Benchmark.h"

namespace dyslam::sim
{
/** Recordings of --count: of consecutive seeds, of the traffic where that has its own; each depends
 * on its seeds alone. \param first first recording, whose `output` is the folder for all
 * \throws UserError if the seeds would exceed the largest int. */
[[nodiscard]] std::vector<NamedRecording> seriesOf(const Arguments& a, const Recording& first);
}  // namespace dyslam::sim
