// SPDX-License-Identifier: BSD-3-Clause
// How a run ended: as planned, early, or without some of its results.
#pragma once

#include <dyslam/run/SlamRun.h>

#include <cstddef>
#include <string>

#include "results/RunResults.h"

namespace dyslam
{
/** Why the run ended early; empty if it did not. \param frames number of processed scans */
[[nodiscard]] std::string earlyEndReason(const EarlyEnd& end, std::size_t frames);

/** \throws UserError, with advice, if the run ended early or results could not be written. */
void requireComplete(const EarlyEnd& end,
                     const RunResults& results,
                     const SlamRunSettings& settings);
}  // namespace dyslam
