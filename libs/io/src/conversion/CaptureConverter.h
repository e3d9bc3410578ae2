// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ScanSink.h"

namespace dyslam
{
/** Passes the scans of a network capture to the sink, and the IMU in its lidar if the options ask
 * for it. \throws UserError if the capture or what is asked of it cannot be read. */
void convertCapture(const std::string& input, ScanSink& sink, const ScanConverterOptions& options);
}  // namespace dyslam
