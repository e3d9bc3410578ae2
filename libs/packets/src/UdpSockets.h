// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/LidarPacket.h>
#include <dyslam/packets/UdpAddress.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace dyslam
{
/** The UDP sockets of the ports on which a lidar sends, with large buffers. */
class UdpSockets
{
 public:
  /** Opens and binds them. \throws UserError. */
  explicit UdpSockets(const UdpAddress& address);
  ~UdpSockets();
  UdpSockets(const UdpSockets&) = delete;
  UdpSockets& operator=(const UdpSockets&) = delete;

  /** Receives the next datagram, with the time at which the system received it.
   * \return false if none comes within the time \throws UserError if receiving fails. */
  [[nodiscard]] bool receive(LidarPacket& packet, std::chrono::milliseconds longest);

  /** The address, with the ports that were found where 0 was given. */
  [[nodiscard]] const UdpAddress& address() const { return address_; }
  /** Number of datagrams so far that the system dropped because a buffer was full. */
  [[nodiscard]] std::uint64_t dropped() const;
  /** Least size that the system grants a buffer [bytes]. */
  [[nodiscard]] std::size_t bufferSize() const { return buffer_size_; }

 private:
  struct Socket
  {
    int descriptor = -1;
    std::uint16_t port = 0;
    std::uint32_t dropped = 0;  //!< by the system's count
  };

  void open(std::uint16_t port);
  /** Receives from a socket that has a datagram. */
  bool receiveFrom(Socket& socket, LidarPacket& packet);

  UdpAddress address_;
  std::vector<Socket> sockets_;
  std::size_t next_ = 0;  //!< the socket that is asked first: none waits for the others
  std::size_t buffer_size_ = 0;
  std::map<std::uint32_t, std::uint64_t> senders_;  //!< numbers of the senders, from 1
  std::vector<std::uint8_t> bytes_;                 //!< room for the largest datagram
};
}  // namespace dyslam
