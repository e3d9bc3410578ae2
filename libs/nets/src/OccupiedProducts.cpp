// SPDX-License-Identifier: BSD-3-Clause
#include "OccupiedProducts.h"

#include <algorithm>
#include <array>

namespace dyslam
{
namespace
{
// Vectors of 8 floats, as GCC and clang have them for every processor.
constexpr std::int64_t lanes = 8;
using Packet = float __attribute__((vector_size(32)));
using UnalignedPacket = float __attribute__((vector_size(32), aligned(4), may_alias));

const UnalignedPacket& packetAt(const float* p)
{
  return *reinterpret_cast<const UnalignedPacket*>(p);
}

UnalignedPacket& packetAt(float* p)
{
  return *reinterpret_cast<UnalignedPacket*>(p);
}

/** A cell's features and where its sums are. */
struct Term
{
  const float* x;
  float* sum;
};

/** Adds x * weights for `cells` cells at once: packets x 8 outputs each. */
template <int cells, int packets>
void addProducts(const Term* terms,
                 std::int64_t channels,
                 const float* weights,
                 std::int64_t stride)
{
  std::array<std::array<Packet, packets>, cells> sums;
#pragma GCC unroll 8
  for (int cell = 0; cell < cells; ++cell)
  {
#pragma GCC unroll 8
    for (int p = 0; p < packets; ++p)
    {
      sums[cell][p] = packetAt(terms[cell].sum + p * lanes);
    }
  }
  for (std::int64_t c = 0; c < channels; ++c, weights += stride)
  {
    std::array<Packet, cells> x;
#pragma GCC unroll 8
    for (int cell = 0; cell < cells; ++cell)
    {
      x[cell] = terms[cell].x[c] - Packet{};
    }
#pragma GCC unroll 8
    for (int p = 0; p < packets; ++p)
    {
      const Packet weight = packetAt(weights + p * lanes);
#pragma GCC unroll 8
      for (int cell = 0; cell < cells; ++cell)
      {
        sums[cell][p] += x[cell] * weight;
      }
    }
  }
#pragma GCC unroll 8
  for (int cell = 0; cell < cells; ++cell)
  {
#pragma GCC unroll 8
    for (int p = 0; p < packets; ++p)
    {
      packetAt(terms[cell].sum + p * lanes) = sums[cell][p];
    }
  }
}

/** All terms, as many at once as the registers hold. */
template <int packets>
void addAll(const std::vector<Term>& terms,
            std::int64_t channels,
            const float* weights,
            std::int64_t stride)
{
  constexpr int cells = packets <= 3 ? 4 : 2;
  std::size_t next = 0;
  for (; next + cells <= terms.size(); next += cells)
  {
    addProducts<cells, packets>(&terms[next], channels, weights, stride);
  }
  for (; next < terms.size(); ++next)
  {
    addProducts<1, packets>(&terms[next], channels, weights, stride);
  }
}

using AddAll = void (*)(const std::vector<Term>&, std::int64_t, const float*, std::int64_t);
constexpr std::array<AddAll, 6> add_all = {&addAll<1>, &addAll<2>, &addAll<3>,
                                           &addAll<4>, &addAll<5>, &addAll<6>};
}  // namespace

OccupiedProducts::OccupiedProducts(const float* rows,
                                   std::int64_t channels,
                                   const float* weight,
                                   std::int64_t positions,
                                   std::int64_t outputs)
    : rows_(rows),
      channels_(channels),
      positions_(positions),
      width_((outputs + lanes - 1) / lanes * lanes),
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
  constexpr auto most_packets = static_cast<std::int64_t>(add_all.size());
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
    for (std::int64_t first = 0; first < width_; first += most_packets * lanes)
    {
      const std::int64_t packets = std::min(most_packets, (width_ - first) / lanes);
      add_all[static_cast<std::size_t>(packets - 1)](terms, channels_, weights + first, width_);
      for (Term& term : terms)
      {
        term.sum += packets * lanes;
      }
    }
  }
}
}  // namespace dyslam
