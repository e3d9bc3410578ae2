// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/LidarPacket.h>

#include <string>
#include <vector>

namespace dyslam
{
/** UDP datagrams one by one, from a network capture or from the network itself. */
class PacketInput
{
 public:
  PacketInput() = default;
  virtual ~PacketInput() = default;
  PacketInput(const PacketInput&) = delete;
  PacketInput& operator=(const PacketInput&) = delete;

  /** For messages: path of the capture, or "udp:2368". */
  [[nodiscard]] virtual const std::string& name() const = 0;
  /** Whether the datagrams are received now: next() waits for them, and they need not end. */
  [[nodiscard]] virtual bool isLive() const = 0;
  /** Reads the next datagram. \return false at the end, and at damage(). \throws UserError. */
  [[nodiscard]] virtual bool next(LidarPacket& packet) = 0;
  /** Reason why the input cannot be read further; empty if it can, or has ended. */
  [[nodiscard]] virtual std::string damage() const = 0;
  /** Fraction that was read, 0 to 1; 0 if it has no known end. */
  [[nodiscard]] virtual double progress() const = 0;
  /** What is missing of it, and the remedy, a line each. */
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
  /** Possible reasons why it has no packets of a lidar: those of warnings(), and others. */
  [[nodiscard]] virtual std::vector<std::string> reasonsForNone() const { return warnings(); }
  /** How to read one of several lidars alone. */
  [[nodiscard]] virtual std::string adviceForSeveral() const = 0;
};
}  // namespace dyslam
