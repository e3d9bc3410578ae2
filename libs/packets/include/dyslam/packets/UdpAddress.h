// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Where this computer receives the datagrams of a lidar (IPv4). */
struct UdpAddress
{
  /** Address of this computer, or a multicast group; empty: every address of this computer. */
  std::string address;
  std::vector<std::uint16_t> ports;  //!< one or more; 0: one that is free

  /** \param text "udp:2368", "udp:192.168.1.77:2368" or "udp:7502,7503"
   * \throws UserError if it is something else. */
  [[nodiscard]] static UdpAddress fromText(const std::string& text);
  /** Reads back as the same. */
  [[nodiscard]] std::string text() const;
  /** The ports as in text(): "7502,7503". */
  [[nodiscard]] std::string portsText() const;
};
}  // namespace dyslam
