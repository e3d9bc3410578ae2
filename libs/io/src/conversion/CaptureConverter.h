// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PacketSource.h>

#include <string>

#include "ScanSink.h"

namespace dyslam
{
/** Passes the scans of a network capture to the sink, and the IMU in its lidar if the options ask
 * for it. \throws UserError if the capture or what is asked of it cannot be read. */
void convertCapture(const std::string& input, ScanSink& sink, const ScanConverterOptions& options);

/** The same for the packets of a capture that is open, or of a lidar on the network. */
void convertPackets(PacketSource& source, ScanSink& sink, const ScanConverterOptions& options);

/** The options of a conversion that are about packets. \throws UserError for an unknown model. */
[[nodiscard]] PacketSourceOptions packetSourceOptions(const ScanConverterOptions& options);
}  // namespace dyslam
