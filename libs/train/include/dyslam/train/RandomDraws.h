// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Splitmix.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dyslam
{
/** Small seeded random numbers (splitmix64) whose draws are the same on every platform. Draws of
 * different seeds or indices are independent, also of neighbouring ones.
 *
 * Several draws in the arguments of one call are not allowed: their order of evaluation is
 * unspecified, but a seed must determine the data. */
class RandomDraws
{
 public:
  RandomDraws(std::uint64_t seed, std::uint64_t index)
      // Each draw adds `splitmix_increment` to the state: seed and index are mixed, so that no two
      // states are a few increments apart.
      : state_(mixedBits(splitmix64(seed) + index))
  {
  }

  std::uint64_t bits()
  {
    state_ += splitmix_increment;
    return mixedBits(state_);
  }
  /** Uniform in [0, 1). */
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /** An integer in [0, count). \pre count is at least 1 */
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(bits() % count); }
  /** An index into a list of weights that is not empty, with a probability proportional to the
   * weight. */
  std::size_t byWeight(const std::vector<double>& weights)
  {
    double rest = uniform() * std::accumulate(weights.begin(), weights.end(), 0.0);
    std::size_t chosen = 0;
    while (chosen + 1 < weights.size() && rest >= weights[chosen])
    {
      rest -= weights[chosen];
      ++chosen;
    }
    return chosen;
  }
  bool chance(double probability) { return uniform() < probability; }
  double normal(double deviation)
  {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return deviation * radius * std::cos(2 * M_PI * uniform());
  }
  /** A normal number for each standard deviation, drawn from the last to the first. */
  template <std::size_t N>
  std::array<double, N> normals(const std::array<double, N>& deviations)
  {
    std::array<double, N> drawn{};
    for (std::size_t i = N; i-- > 0;)
    {
      drawn[i] = normal(deviations[i]);
    }
    return drawn;
  }

 private:
  std::uint64_t state_;
};
}  // namespace dyslam
