// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace dyslam
{
/** Increment of the state of splitmix64 (Steele, Lea and Flood, 2014) per draw. */
constexpr std::uint64_t splitmix_increment = 0x9E3779B97F4A7C15ULL;

/** The finaliser of splitmix64: a bijection whose output bits depend on all input bits. */
constexpr std::uint64_t mixedBits(std::uint64_t x)
{
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}

/** Output of splitmix64 for a state; a hash of the state. */
constexpr std::uint64_t splitmix64(std::uint64_t state)
{
  return mixedBits(state + splitmix_increment);
}
}  // namespace dyslam
