// SPDX-License-Identifier: BSD-3-Clause
// Others in a domain of ROS 2 that only this program and those it starts use, on this computer.
#pragma once

#include <dyslam/ros2/Ros2Domain.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace dyslam::test
{
inline Ros2DomainOptions ownDomain()
{
  // The ports of domains from 102 on may be those of other programs.
  return {2 + static_cast<unsigned>(::getpid()) % 100, true};
}

inline std::unique_ptr<Ros2Domain> joinOwnDomain()
{
  return openRos2Domain("the test", ownDomain());
}

/** Makes the own domain that of all programs that are started from now on. */
inline void setOwnDomain()
{
  ::setenv("ROS_DOMAIN_ID", std::to_string(ownDomain().id).c_str(), 1);
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
}

/** Looks every few milliseconds whether something is so, half a minute at most. */
inline bool waitUntil(const std::function<bool()>& isSo)
{
  const auto begin = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begin < std::chrono::seconds(30))
  {
    if (isSo())
    {
      return true;
    }
    ::usleep(2000);
  }
  return false;
}

/** Waits for the next message, half a minute at most. */
inline bool receiveNext(Ros2Domain& domain, Ros2Message& message)
{
  return waitUntil([&] { return domain.receive(message, std::chrono::milliseconds(100)); });
}
}  // namespace dyslam::test
