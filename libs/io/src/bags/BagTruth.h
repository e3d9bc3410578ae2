// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/Bag.h>

#include <string>

#include "conversion/ScanSink.h"

namespace dyslam
{
/** True poses of the vehicle from the topic that the options name. \throws UserError unless it has
 * two poses or more, of one body. */
[[nodiscard]] Trajectory readTruePoses(const std::string& input,
                                       Bag& bag,
                                       const ScanConverterOptions& options,
                                       ScanSink& sink);
}  // namespace dyslam
