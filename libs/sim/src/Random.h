// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Splitmix.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace dyslam::sim
{
inline std::uint64_t combine(std::uint64_t a, std::uint64_t b)
{
  return splitmix64(a ^ (b + splitmix_increment + (a << 6) + (a >> 2)));
}

/** Uniform in [0, 1) from the top bits of a hash. */
inline float unit(std::uint64_t hash)
{
  return static_cast<float>(hash >> 40) * 0x1p-24F;
}

/** Approximately normal with standard deviation 1, bounded by 3.46: the sum of four uniforms. */
inline float normal(std::uint64_t hash)
{
  const auto part = [&](int shift)
  { return static_cast<float>((hash >> shift) & 0xFFFFU) * (1.0F / 65535.0F); };
  return (part(0) + part(16) + part(32) + part(48) - 2.0F) * 1.7320508F;
}

/** Pseudo-random generator for worlds and traffic; not shared between threads.
 *
 * Several draws in the arguments of one call are not allowed: their order of evaluation is
 * unspecified, but a seed must determine the world. */
class Rng
{
 public:
  explicit Rng(std::uint64_t seed) : state_(splitmix64(seed)) {}

  std::uint64_t bits() { return splitmix64(state_++); }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  float uniformFloat(double low, double high) { return static_cast<float>(uniform(low, high)); }
  int below(int count) { return static_cast<int>(uniform() * count); }
  bool chance(double probability) { return uniform() < probability; }
  /** A random element of a list that is not empty. */
  template <typename T>
  const T& pick(const std::vector<T>& list)
  {
    return list[static_cast<std::size_t>(below(static_cast<int>(list.size())))];
  }
  double gaussian() { return static_cast<double>(normal(bits())); }

 private:
  std::uint64_t state_;
};

namespace detail
{
inline float latticeValue(int x, int y, int z)
{
  auto h = static_cast<std::uint32_t>(x) * 0x8DA6B343U ^
           static_cast<std::uint32_t>(y) * 0xD8163841U ^
           static_cast<std::uint32_t>(z) * 0xCB1AB31FU;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  h ^= h >> 12;
  return static_cast<float>(h >> 8) * (2.0F / 16777215.0F) - 1.0F;
}
}  // namespace detail

/** Value noise in [-1, 1], constant in time, with features of about one unit. */
inline float latticeNoise(float x, float y, float z)
{
  const float fx = std::floor(x), fy = std::floor(y), fz = std::floor(z);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy), iz = static_cast<int>(fz);
  const auto ease = [](float t) { return t * t * (3.0F - 2.0F * t); };
  const float u = ease(x - fx), v = ease(y - fy), w = ease(z - fz);
  const auto row = [&](int dy, int dz)
  {
    const float a = detail::latticeValue(ix, iy + dy, iz + dz);
    return a + u * (detail::latticeValue(ix + 1, iy + dy, iz + dz) - a);
  };
  const float y0 = row(0, 0) + v * (row(1, 0) - row(0, 0));
  const float y1 = row(0, 1) + v * (row(1, 1) - row(0, 1));
  return y0 + w * (y1 - y0);
}
}  // namespace dyslam::sim
