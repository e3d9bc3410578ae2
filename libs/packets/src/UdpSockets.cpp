// SPDX-License-Identifier: BSD-3-Clause
#include "UdpSockets.h"

#include <arpa/inet.h>
#include <dyslam/base/Error.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <string>

#include "CaptureDecoder.h"

namespace dyslam
{
namespace
{
/** Asked for; the system grants up to net.core.rmem_max. A VLS-128 fills it in three seconds. */
constexpr int wanted_buffer = 1 << 25;  // [bytes]
constexpr std::size_t largest_datagram = 65536;

sockaddr_in socketAddress(const std::string& address, std::uint16_t port)
{
  sockaddr_in result = {};
  result.sin_family = AF_INET;
  result.sin_port = htons(port);
  result.sin_addr.s_addr = htonl(INADDR_ANY);
  if (!address.empty())
  {
    ::inet_pton(AF_INET, address.c_str(), &result.sin_addr);
  }
  return result;
}

bool isMulticast(const sockaddr_in& address)
{
  return IN_MULTICAST(ntohl(address.sin_addr.s_addr));
}

/** What the user should do about a port that cannot be bound. */
std::string whyNotBound(const UdpAddress& address, std::uint16_t port, int reason)
{
  const std::string name = "--input " + address.text() + ": ";
  const std::string number = std::to_string(port);
  switch (reason)
  {
    case EADDRINUSE:
      return name + "another program receives on UDP port " + number +
             ": end it (ss -lunp names it), or set another port in the lidar";
    case EACCES:
      return name + "UDP port " + number +
             " is kept for root; set a port from 1024 on in the lidar, and give that";
    case EADDRNOTAVAIL:
      return name + address.address +
             " is no address of this computer (ip address lists them); without it, udp:" + number +
             ", all are used";
    default:
      return name + "UDP port " + number + " cannot be opened: " + std::strerror(reason);
  }
}

void enable(int descriptor, int option)
{
  const int on = 1;
  (void)::setsockopt(descriptor, SOL_SOCKET, option, &on, sizeof on);
}

/** Asks for a large buffer; root may exceed the system's limit. \return its size [bytes] */
std::size_t enlargeBuffer(int descriptor)
{
  if (::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &wanted_buffer, sizeof wanted_buffer) !=
      0)
  {
    (void)::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &wanted_buffer, sizeof wanted_buffer);
  }
  int size = 0;
  socklen_t length = sizeof size;
  (void)::getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, &length);
  return static_cast<std::size_t>(std::max(size, 0));
}

double secondsOf(const timespec& time)
{
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
}  // namespace

UdpSockets::UdpSockets(const UdpAddress& address) : address_(address), bytes_(largest_datagram)
{
  try
  {
    for (std::uint16_t& port : address_.ports)
    {
      open(port);
      port = sockets_.back().port;
    }
  }
  catch (...)
  {
    for (const Socket& socket : sockets_)
    {
      ::close(socket.descriptor);
    }
    throw;
  }
}

UdpSockets::~UdpSockets()
{
  for (const Socket& socket : sockets_)
  {
    ::close(socket.descriptor);
  }
}

void UdpSockets::open(std::uint16_t port)
{
  Socket socket;
  socket.descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket.descriptor < 0)
  {
    throw UserError(whyNotBound(address_, port, errno));
  }
  sockets_.push_back(socket);  // closed whatever happens
  sockaddr_in bound = socketAddress(address_.address, port);
  if (::bind(socket.descriptor, reinterpret_cast<const sockaddr*>(&bound), sizeof bound) != 0)
  {
    throw UserError(whyNotBound(address_, port, errno));
  }
  if (isMulticast(bound))
  {
    ip_mreq group = {};
    group.imr_multiaddr = bound.sin_addr;
    if (::setsockopt(socket.descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0)
    {
      throw UserError("--input " + address_.text() + ": the multicast group cannot be joined: " +
                      std::strerror(errno) + "; check the network interface and its route");
    }
  }
  enable(socket.descriptor, SO_TIMESTAMPNS);
  enable(socket.descriptor, SO_RXQ_OVFL);
  const std::size_t size = enlargeBuffer(socket.descriptor);
  buffer_size_ = sockets_.size() == 1 ? size : std::min(buffer_size_, size);
  socklen_t length = sizeof bound;
  (void)::getsockname(socket.descriptor, reinterpret_cast<sockaddr*>(&bound), &length);
  sockets_.back().port = ntohs(bound.sin_port);
}

std::uint64_t UdpSockets::dropped() const
{
  std::uint64_t sum = 0;
  for (const Socket& socket : sockets_)
  {
    sum += socket.dropped;
  }
  return sum;
}

bool UdpSockets::receive(LidarPacket& packet, std::chrono::milliseconds longest)
{
  std::vector<pollfd> waiting;
  for (const Socket& socket : sockets_)
  {
    waiting.push_back({socket.descriptor, POLLIN, 0});
  }
  if (::poll(waiting.data(), waiting.size(), static_cast<int>(longest.count())) <= 0)
  {
    return false;  // a signal ends the waiting, too
  }
  for (std::size_t i = 0; i < sockets_.size(); ++i)
  {
    const std::size_t at = (next_ + i) % sockets_.size();
    if (waiting[at].revents != 0 && receiveFrom(sockets_[at], packet))
    {
      next_ = at + 1;
      return true;
    }
  }
  return false;
}

bool UdpSockets::receiveFrom(Socket& socket, LidarPacket& packet)
{
  sockaddr_in sender = {};
  iovec data = {bytes_.data(), bytes_.size()};
  alignas(cmsghdr) std::array<char, 256> control{};
  msghdr message = {};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = ::recvmsg(socket.descriptor, &message, 0);
  if (size < 0)
  {
    if (errno == EAGAIN || errno == EINTR || errno == ECONNREFUSED)
    {
      return false;
    }
    throw UserError(address_.text() + ": receiving fails: " + std::strerror(errno));
  }
  timespec time = {};
  (void)::clock_gettime(CLOCK_REALTIME, &time);  // if the system does not tell its own
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part))
  {
    if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SCM_TIMESTAMPNS)
    {
      std::memcpy(&time, CMSG_DATA(part), sizeof time);
    }
    if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SO_RXQ_OVFL)
    {
      std::memcpy(&socket.dropped, CMSG_DATA(part), sizeof socket.dropped);
    }
  }
  packet.bytes.assign(bytes_.begin(), bytes_.begin() + size);
  packet.captured = secondsOf(time);
  const std::uint64_t number =
      senders_.emplace(sender.sin_addr.s_addr, senders_.size() + 1).first->second;
  packet.stream = number << port_bits | socket.port;
  return true;
}
}  // namespace dyslam
