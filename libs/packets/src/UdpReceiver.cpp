// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/packets/UdpReceiver.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "UdpSockets.h"

namespace dyslam
{
namespace
{
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds stop_check(100);  //!< between two looks at `stop`
/** Datagrams that wait for next(): a minute of an OS1-128. */
constexpr std::size_t most_waiting = std::size_t{1} << 30U;  // [bytes]

double secondsSince(Clock::time_point start)
{
  return std::chrono::duration<double>(Clock::now() - start).count();
}
}  // namespace

struct UdpReceiver::Impl
{
  Impl(const UdpAddress& address, UdpReceiverOptions options_in)
      : options(std::move(options_in)),
        sockets(address),
        name(sockets.address().text()),
        thread([this] { receiveAll(); })
  {
  }
  ~Impl()
  {
    is_closing = true;
    thread.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /** In the thread: keeps the datagrams until the input ends. */
  void receiveAll()
  {
    std::exception_ptr why;
    try
    {
      LidarPacket packet;
      while (!is_closing && !(options.stop && options.stop()))
      {
        if (sockets.receive(packet, stop_check))
        {
          keep(std::move(packet));
        }
      }
    }
    catch (...)
    {
      why = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    dropped = sockets.dropped();
    failure = why;
    is_ended = true;
    changed.notify_all();
  }

  void keep(LidarPacket packet)
  {
    const std::lock_guard<std::mutex> lock(mutex);
    dropped = sockets.dropped();
    ++received;
    if (waiting_bytes + packet.bytes.size() > most_waiting)
    {
      ++left_out;
      return;
    }
    waiting_bytes += packet.bytes.size();
    waiting.push_back(std::move(packet));
    changed.notify_all();
  }

  /** \throws UserError if the first datagram is overdue; tells `warn` if the next one is. */
  void noteWaiting()
  {
    const double seconds = secondsSince(last);
    if (!any && seconds > options.first_wait)
    {
      throw UserError(whyNothing());
    }
    if (any && !is_silent && seconds > options.silence)
    {
      is_silent = true;
      warn(formatted("no packets for %.0f s; the recording goes on when they come again", seconds));
    }
  }

  void noteReceived()
  {
    if (is_silent)
    {
      warn(formatted("packets again, after %.0f s", secondsSince(last)));
    }
    is_silent = false;
    any = true;
    last = Clock::now();
  }

  void warn(const std::string& what) const
  {
    if (options.warn)
    {
      options.warn(name + ": " + what);
    }
  }

  [[nodiscard]] std::string whyNothing() const
  {
    const UdpAddress& address = sockets.address();
    return formatted("%s: no packets within %g s; check that the lidar is on and sends to ",
                     name.c_str(), options.first_wait) +
           (address.address.empty() ? "this computer" : address.address) + ", UDP port " +
           address.portsText() +
           " (the destination in its settings), and that no firewall drops them: sudo tcpdump -ni "
           "any udp shows what arrives";
  }

  UdpReceiverOptions options;
  UdpSockets sockets;  //!< behind the constructor only the thread receives
  std::string name;
  // Of next(), in the caller's thread.
  bool any = false;        //!< a datagram was taken
  bool is_silent = false;  //!< the silence was told
  Clock::time_point last = Clock::now();
  // Of both threads.
  mutable std::mutex mutex;  //!< of all up to `failure`
  std::condition_variable changed;
  std::deque<LidarPacket> waiting;
  std::size_t waiting_bytes = 0;
  std::size_t received = 0;    //!< number of datagrams
  std::uint64_t dropped = 0;   //!< UdpSockets::dropped()
  std::uint64_t left_out = 0;  //!< number of datagrams for which there was no room here
  bool is_ended = false;
  std::exception_ptr failure;
  std::atomic<bool> is_closing = false;
  std::thread thread;  // last, as it uses the others
};

UdpReceiver::UdpReceiver(const UdpAddress& address, UdpReceiverOptions options)
    : impl_(std::make_unique<Impl>(address, std::move(options)))
{
}

UdpReceiver::~UdpReceiver() = default;

const std::string& UdpReceiver::name() const
{
  return impl_->name;
}

const UdpAddress& UdpReceiver::address() const
{
  return impl_->sockets.address();
}

std::size_t UdpReceiver::received() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->received;
}

bool UdpReceiver::next(LidarPacket& packet)
{
  Impl& m = *impl_;
  for (;;)
  {
    {
      std::unique_lock<std::mutex> lock(m.mutex);
      m.changed.wait_for(lock, stop_check, [&m] { return !m.waiting.empty() || m.is_ended; });
      if (!m.waiting.empty())
      {
        packet = std::move(m.waiting.front());
        m.waiting.pop_front();
        m.waiting_bytes -= packet.bytes.size();
        break;
      }
      if (m.failure)
      {
        std::rethrow_exception(m.failure);
      }
      if (m.is_ended)
      {
        return false;
      }
    }
    m.noteWaiting();
  }
  m.noteReceived();
  return true;
}

std::vector<std::string> UdpReceiver::warnings() const
{
  const Impl& m = *impl_;
  const std::lock_guard<std::mutex> lock(m.mutex);
  std::vector<std::string> lines;
  if (m.dropped > 0)
  {
    lines.push_back(counted(m.dropped, "packet") + " lost, as the system's buffer of " +
                    std::to_string(m.sockets.bufferSize() >> 10U) +
                    " KiB was full; allow a larger one: sudo sysctl -w net.core.rmem_max=33554432");
  }
  if (m.left_out > 0)
  {
    lines.push_back(counted(m.left_out, "packet") +
                    " left out, as they came faster than they could be recorded; record to a "
                    "faster disk, or with fewer programs beside");
  }
  return lines;
}

std::string UdpReceiver::adviceForSeveral() const
{
  return "set another port in each lidar, and record each by its own";
}
}  // namespace dyslam
