// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/LidarPacket.h>

#include <string>

namespace dyslam
{
/** \param captured when it was received, UNIX time [s] */
inline LidarPacket received(const std::string& bytes, double captured = 1000)
{
  return {{bytes.begin(), bytes.end()}, captured, 0};
}
}  // namespace dyslam
