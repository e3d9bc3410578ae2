// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapbuilder/MapListener.h>

#include <functional>
#include <string>

namespace dyslam
{
/** Reads all scans, with Frame::sweep_duration; that of the first scan is the second's.
 * \param purpose as MapListener::beginReading()
 * \param use called with every scan, in order
 * \return empty; for a rawlog that is damaged what is wrong with it, after the scans before the
 * damage. */
[[nodiscard]] std::string readScans(RawlogSource& source,
                                    const std::string& purpose,
                                    MapListener& listener,
                                    const std::function<void(Frame)>& use);

/** readScans(), and hands the warnings about the recording to the listener. */
[[nodiscard]] std::string readScansAndWarn(RawlogSource& source,
                                           const std::string& purpose,
                                           MapListener& listener,
                                           const std::function<void(Frame)>& use);
}  // namespace dyslam
