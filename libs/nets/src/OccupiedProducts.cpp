// SPDX-License-Identifier: BSD-3-Clause
#include "OccupiedProducts.h"

#include <algorithm>
#include <array>

namespace dyslam
{
namespace
{
/** A cell's features and the address of its sums. */
struct Term
{
  const float* x;
  float* sum;
};

/** Adds the products of `count` cells with a position's weights. */
using AddAll = void (*)(const Term* terms,
                        std::size_t count,
                        std::int64_t channels,
                        const float* weights,
                        std::int64_t stride);

namespace vectors_of_8
{
#define DYSLAM_LANES 8
#define DYSLAM_REGISTERS 16
#define DYSLAM_TARGET
#include "OccupiedKernel.inc"
#undef DYSLAM_LANES
#undef DYSLAM_REGISTERS
#undef DYSLAM_TARGET
}  // namespace vectors_of_8

// If all code is compiled for processors with FMA, AVX-512 gives the same sums.
#if defined(__x86_64__) && defined(__FMA__)
namespace vectors_of_16
{
#define DYSLAM_LANES 16
#define DYSLAM_REGISTERS 32
#define DYSLAM_TARGET __attribute__((target("avx512f")))
#include "OccupiedKernel.inc"
#undef DYSLAM_LANES
#undef DYSLAM_REGISTERS
#undef DYSLAM_TARGET
}  // namespace vectors_of_16
#endif

}  // namespace

struct OccupiedProducts::Kernel
{
  std::int64_t lanes;
  std::array<AddAll, 6> add_all;
};

const OccupiedProducts::Kernel& OccupiedProducts::kernelFor(bool wide)
{
  static constexpr Kernel of_8{vectors_of_8::lanes, vectors_of_8::add_all};
#if defined(__x86_64__) && defined(__FMA__)
  static constexpr Kernel of_16{vectors_of_16::lanes, vectors_of_16::add_all};
  static const bool has_avx512 = __builtin_cpu_supports("avx512f") != 0;
  return wide && has_avx512 ? of_16 : of_8;
#else
  (void)wide;
  return of_8;
#endif
}

OccupiedProducts::OccupiedProducts(const float* rows,
                                   std::int64_t channels,
                                   const float* weight,
                                   std::int64_t positions,
                                   std::int64_t outputs,
                                   bool wide)
    : kernel_(kernelFor(wide)),
      rows_(rows),
      channels_(channels),
      positions_(positions),
      width_((outputs + kernel_.lanes - 1) / kernel_.lanes * kernel_.lanes),
      weight_(static_cast<std::size_t>(positions * channels * width_), 0.0F)
{
  const std::int64_t inputs = positions * channels;
  for (std::int64_t o = 0; o < outputs; ++o)
  {
    for (std::int64_t i = 0; i < inputs; ++i)
    {
      weight_[static_cast<std::size_t>(i * width_ + o)] = weight[o * inputs + i];
    }
  }
}

void OccupiedProducts::addTo(const std::int32_t* table, std::int64_t count, float* sums) const
{
  const auto most_packets = static_cast<std::int64_t>(kernel_.add_all.size());
  std::vector<Term> terms;
  terms.reserve(static_cast<std::size_t>(count));
  for (std::int64_t position = 0; position < positions_; ++position)
  {
    terms.clear();
    for (std::int64_t i = 0; i < count; ++i)
    {
      const std::int32_t row = table[i * positions_ + position];
      if (row >= 0)
      {
        terms.push_back({rows_ + row * channels_, sums + i * width_});
      }
    }
    const float* weights = &weight_[static_cast<std::size_t>(position * channels_ * width_)];
    for (std::int64_t first = 0; first < width_; first += most_packets * kernel_.lanes)
    {
      const std::int64_t packets = std::min(most_packets, (width_ - first) / kernel_.lanes);
      kernel_.add_all[static_cast<std::size_t>(packets - 1)](terms.data(), terms.size(), channels_,
                                                             weights + first, width_);
      for (Term& term : terms)
      {
        term.sum += packets * kernel_.lanes;
      }
    }
  }
}
}  // namespace dyslam
