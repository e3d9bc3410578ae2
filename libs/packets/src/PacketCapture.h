// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/LidarPacket.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "FragmentedDatagrams.h"

struct pcap;

namespace dyslam
{
/** The UDP datagrams of a network capture (.pcap, .pcapng) one by one, over IPv4 or IPv6, put
 * together from their fragments. */
class PacketCapture
{
 public:
  /** \throws UserError if the file is missing or no capture. */
  explicit PacketCapture(const std::string& path);

  /** Reads the next datagram; false at the end of the file and at damage, see damage(). */
  [[nodiscard]] bool next(LidarPacket& packet);

  /** Reason why the file cannot be read further; empty if it can, or has ended. */
  [[nodiscard]] const std::string& damage() const { return damage_; }
  /** Whether there are interfaces of another kind or snapshot length than the first one, whose
   * frames libpcap does not read. */
  [[nodiscard]] bool hasOtherInterfaces() const { return has_other_interfaces_; }
  /** Whether UDP frames were captured in part, for a short snapshot length. */
  [[nodiscard]] bool hasCutFrames() const { return has_cut_frames_; }
  /** Fraction of the file that was read, 0 to 1. */
  [[nodiscard]] double progress() const;

 private:
  std::unique_ptr<pcap, void (*)(pcap*)> file_;
  FragmentedDatagrams fragments_;
  std::map<IpAddress, std::uint64_t> senders_;  //!< numbers of the senders, from 1
  std::uintmax_t size_ = 0;                     //!< size of the file [bytes]
  std::string damage_;
  bool has_other_interfaces_ = false;
  bool has_cut_frames_ = false;
};
}  // namespace dyslam
