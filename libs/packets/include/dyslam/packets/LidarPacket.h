// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace dyslam
{
/** The payload of one UDP datagram. */
struct LidarPacket
{
  std::vector<std::uint8_t> bytes;
  double captured = 0;       //!< time of reception, UNIX time [s]
  std::uint64_t stream = 0;  //!< number of the sender and receiver's port; 0 in bags
};
}  // namespace dyslam
