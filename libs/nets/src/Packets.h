// SPDX-License-Identifier: BSD-3-Clause
// Vectors of 8 floats, as GCC and clang have them for every processor.
#pragma once

#include <cstdint>

namespace dyslam
{
constexpr std::int64_t lanes = 8;
using Packet = float __attribute__((vector_size(32)));
using UnalignedPacket = float __attribute__((vector_size(32), aligned(4), may_alias));

inline const UnalignedPacket& packetAt(const float* p)
{
  return *reinterpret_cast<const UnalignedPacket*>(p);
}

inline UnalignedPacket& packetAt(float* p)
{
  return *reinterpret_cast<UnalignedPacket*>(p);
}
}  // namespace dyslam
