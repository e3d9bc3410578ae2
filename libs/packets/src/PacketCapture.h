// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PacketInput.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "FragmentedDatagrams.h"

struct pcap;

namespace dyslam
{
/** The UDP datagrams of a network capture (.pcap, .pcapng) one by one, over IPv4 or IPv6, put
 * together from their fragments. */
class PacketCapture : public PacketInput
{
 public:
  /** \throws UserError if the file is missing or no capture. */
  explicit PacketCapture(const std::string& path);

  [[nodiscard]] const std::string& name() const override { return path_; }
  [[nodiscard]] bool isLive() const override { return false; }
  [[nodiscard]] bool next(LidarPacket& packet) override;
  [[nodiscard]] std::string damage() const override { return damage_; }
  [[nodiscard]] double progress() const override;
  [[nodiscard]] std::vector<std::string> warnings() const override;
  [[nodiscard]] std::vector<std::string> reasonsForNone() const override;
  [[nodiscard]] std::string adviceForSeveral() const override;

 private:
  std::string path_;
  std::unique_ptr<pcap, void (*)(pcap*)> file_;
  FragmentedDatagrams fragments_;
  std::map<IpAddress, std::uint64_t> senders_;  //!< numbers of the senders, from 1
  std::uintmax_t size_ = 0;                     //!< size of the file [bytes]
  std::string damage_;
  bool has_other_interfaces_ = false;  //!< of another kind or snapshot length than the first one,
                                       //!< whose frames libpcap does not read
  bool has_cut_frames_ = false;        //!< UDP frames captured in part, for a short snapshot length
};
}  // namespace dyslam
