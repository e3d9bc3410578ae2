// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PacketInput.h>
#include <dyslam/packets/UdpAddress.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
struct UdpReceiverOptions
{
  double first_wait = 10;      //!< longest time without a first datagram [s]
  double silence = 5;          //!< time without datagrams after which `warn` is told [s]
  std::function<bool()> stop;  //!< true: the input ends; asked every 0.1 s, from any thread
  std::function<void(const std::string&)> warn;  //!< told in next(): a line about the input
};

/** The datagrams that a lidar sends to this computer. A thread receives them and keeps those that
 * were not taken yet, so that the system's buffer does not fill up while next() is not called. */
class UdpReceiver : public PacketInput
{
 public:
  /** Begins to receive. \throws UserError if a port cannot be opened. */
  explicit UdpReceiver(const UdpAddress& address, UdpReceiverOptions options = {});
  ~UdpReceiver() override;

  [[nodiscard]] const std::string& name() const override;
  [[nodiscard]] bool isLive() const override { return true; }
  /** Waits for the next datagram. \return false once `stop` is true and all that were received
   * before were taken \throws UserError if there is no first one within `first_wait`, or receiving
   * fails. */
  [[nodiscard]] bool next(LidarPacket& packet) override;
  [[nodiscard]] std::string damage() const override { return ""; }
  [[nodiscard]] double progress() const override { return 0; }
  [[nodiscard]] std::vector<std::string> warnings() const override;
  [[nodiscard]] std::string adviceForSeveral() const override;

  /** The address, with the ports that were found where 0 was given. */
  [[nodiscard]] const UdpAddress& address() const;
  /** Number of datagrams that were received so far, taken by next() or not. */
  [[nodiscard]] std::size_t received() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
