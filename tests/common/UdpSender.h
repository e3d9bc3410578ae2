// SPDX-License-Identifier: BSD-3-Clause
// Sends datagrams as a lidar does, on this computer.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace dyslam::test
{
/** One sender: its datagrams come from one address and port. */
class UdpSender
{
 public:
  /** \param from address of the sender, in 127.0.0.0/8 */
  explicit UdpSender(const std::string& from = "127.0.0.1")
      : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0))
  {
    const sockaddr_in own = address(from, 0);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
    {
      throw std::runtime_error("UdpSender: cannot bind " + from);
    }
  }
  ~UdpSender() { ::close(socket_); }
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  void send(const std::string& bytes, std::uint16_t port) const
  {
    const sockaddr_in to = address("127.0.0.1", port);
    const ssize_t sent = ::sendto(socket_, bytes.data(), bytes.size(), 0,
                                  reinterpret_cast<const sockaddr*>(&to), sizeof to);
    if (sent != static_cast<ssize_t>(bytes.size()))
    {
      throw std::runtime_error("UdpSender: cannot send");
    }
  }

 private:
  static sockaddr_in address(const std::string& text, std::uint16_t port)
  {
    sockaddr_in result = {};
    result.sin_family = AF_INET;
    result.sin_port = htons(port);
    ::inet_pton(AF_INET, text.c_str(), &result.sin_addr);
    return result;
  }

  int socket_;
};
}  // namespace dyslam::test
