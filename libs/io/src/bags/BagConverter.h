// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/ScanConverter.h>

#include <functional>
#include <string>

#include "conversion/ScanSink.h"

namespace dyslam
{
/** Writes the scans of a ROS bag. \param unpacking see openBag() \throws UserError. */
void convertBag(const std::string& input,
                ScanSink& sink,
                const ScanConverterOptions& options,
                const BagUnpackingProgress& unpacking);
/** Writes the scans of a bag that is open, or live. \param input name for messages
 * \param vehicle_frame is called with the name of the vehicle frame before the first scan, unless
 * null: that of the lidar, if the options name none \throws UserError. */
void convertMessages(const std::string& input,
                     Bag& bag,
                     ScanSink& sink,
                     const ScanConverterOptions& options,
                     const std::function<void(const std::string&)>& vehicle_frame = {});
}  // namespace dyslam
