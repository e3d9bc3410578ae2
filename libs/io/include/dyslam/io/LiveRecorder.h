// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/ScanConverter.h>

#include <cstddef>
#include <functional>
#include <string>

namespace dyslam
{
/** What a recording asks and tells while it goes on; each may be null. */
struct LiveRecorderHooks
{
  std::function<bool()> stop;  //!< true: the recording ends; asked from several threads
  /** What is waited for, from now on: "packets on udp:2368", "messages of /points (ROS 2, domain
   * 0)". */
  std::function<void(const std::string&)> listening;
  std::function<void(const std::string&)> warn;  //!< a line, at once
  /** The frame that topics have for the vehicle of the recording, before its first scan; not called
   * for other inputs. */
  std::function<void(const std::string&)> vehicle_frame;
  std::function<void(std::size_t)> recorded;  //!< a scan is in the rawlog: number of scans so far
};

/** Writes the scans of a lidar on the network, or of live topics of ROS 2, to a rawlog while they
 * arrive, until `stop` is true or as many as the options ask for are written.
 *
 * The rawlog grows under its name: every scan is there, for all readers, once it is complete, and
 * stays there whatever happens. RawlogSource follows it. An earlier rawlog of the name is replaced
 * when the first scan has been received.
 * \param input see isLiveInput(), UdpAddress \throws UserError if a port cannot be opened or a
 * domain not be joined, no scans of a known lidar arrive, the options do not fit, or the rawlog
 * cannot be written. */
ConversionResult recordLive(const std::string& input,
                            const std::string& output,
                            const ScanConverterOptions& options,
                            const LiveRecorderHooks& hooks = {});

/** Table of the topics in the domain of ROS 2, as listingOf() a bag of what is published within a
 * few seconds. \param stop ends that time \throws UserError if there are none. */
[[nodiscard]] std::string listLiveTopics(const std::function<bool()>& stop);
}  // namespace dyslam
