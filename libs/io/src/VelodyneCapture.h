// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "VelodynePackets.h"

struct pcap;

namespace dyslam
{
/** One data packet of a Velodyne lidar. */
struct CapturedPacket
{
  std::array<std::uint8_t, velodyne_packet_size> bytes{};
  double captured = 0;  //!< UNIX time [s]

  [[nodiscard]] VelodynePacketView view() const { return {bytes.data()}; }
};

/** The Velodyne data packets of a network capture (.pcap, .pcapng) one by one: UDP packets of 1206
 * bytes, those of the sender and port of the first one. */
class VelodyneCapture
{
 public:
  /** \throws UserError if the file is missing or no capture. */
  explicit VelodyneCapture(const std::string& path);

  /** False at the end of the file, and where it is damaged: see damage(). */
  [[nodiscard]] bool next(CapturedPacket& packet);

  /** Why the file cannot be read further; empty if it can, or has ended. */
  [[nodiscard]] const std::string& damage() const { return damage_; }
  /** Packets delivered so far. */
  [[nodiscard]] std::size_t count() const { return count_; }
  /** Data packets of other lidars than the first. */
  [[nodiscard]] std::size_t ofOthers() const { return of_others_; }
  /** Part of the file that was read, 0 to 1. */
  [[nodiscard]] double progress() const;

 private:
  std::unique_ptr<pcap, void (*)(pcap*)> file_;
  std::uintmax_t size_ = 0;  //!< of the file [bytes]
  std::size_t count_ = 0;
  std::size_t of_others_ = 0;
  std::optional<std::uint64_t> stream_;  //!< sender and port of the first data packet
  std::string damage_;
};
}  // namespace dyslam
