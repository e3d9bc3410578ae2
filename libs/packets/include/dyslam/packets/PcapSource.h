// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PacketSource.h>

#include <string>

namespace dyslam
{
using PcapSourceOptions = PacketSourceOptions;

/** Scans out of a network capture (.pcap, .pcapng) of one lidar. */
class PcapSource : public PacketSource
{
 public:
  /** \throws UserError if the file is missing, no pcap, or has no packets that are read. */
  explicit PcapSource(const std::string& path, const PcapSourceOptions& options = {});
};
}  // namespace dyslam
