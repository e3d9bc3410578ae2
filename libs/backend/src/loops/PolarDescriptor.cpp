// SPDX-License-Identifier: BSD-3-Clause
#include "PolarDescriptor.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Bytes.h>

#include <algorithm>
#include <bitset>
#include <cmath>

#include "GroundHeight.h"

namespace dyslam
{
namespace
{
constexpr float height_step = 1.0F / 16;

/** Cyclic shift over the sectors: bit i of the result is bit i + shift of `bits`. */
std::uint64_t rotated(std::uint64_t bits, std::size_t shift)
{
  constexpr std::uint64_t all = (std::uint64_t{1} << PolarDescriptor::sectors) - 1;
  return shift == 0 ? bits : ((bits >> shift) | (bits << (PolarDescriptor::sectors - shift))) & all;
}
}  // namespace

PolarDescriptor::PolarDescriptor(const std::vector<Eigen::Vector3f>& points,
                                 double max_range,
                                 const Eigen::Vector2f& viewpoint)
{
  const float ground = groundHeight(points, 20);
  const auto ring_width = static_cast<float>(max_range / static_cast<double>(rings));
  for (const Eigen::Vector3f& p : points)
  {
    const Eigen::Vector2f flat = p.head<2>() - viewpoint;
    const float range = flat.norm();
    if (!p.allFinite() || range >= static_cast<float>(max_range) || range < 1e-3F)
    {
      continue;
    }
    const auto ring = std::min(rings - 1, static_cast<std::size_t>(range / ring_width));
    const double turn = std::atan2(flat.y(), flat.x()) / (2 * M_PI);
    const auto sector =
        static_cast<std::size_t>((turn < 0 ? turn + 1 : turn) * static_cast<double>(sectors)) %
        sectors;
    const float steps = std::clamp((p.z() - ground) / height_step, 0.0F, 254.0F) + 1;
    std::uint8_t& cell = heights_[sector * rings + ring];
    cell = std::max(cell, static_cast<std::uint8_t>(steps));
  }
  for (std::size_t i = 0; i < heights_.size(); ++i)
  {
    ring_means_[i % rings] += static_cast<float>(heights_[i]) / static_cast<float>(sectors);
  }
}

PolarDescriptor::Columns PolarDescriptor::columns() const
{
  Columns result;
  for (std::size_t s = 0; s < sectors; ++s)
  {
    Column& column = result.column[s];
    for (std::size_t r = 0; r < rings; ++r)
    {
      column[static_cast<Eigen::Index>(r)] = static_cast<float>(heights_[s * rings + r]);
    }
    const float norm = column.norm();
    if (norm > 0)
    {
      column /= norm;
      result.seen |= std::uint64_t{1} << s;
    }
  }
  return result;
}

PolarDescriptor::Match PolarDescriptor::match(const PolarDescriptor& other) const
{
  return match(columns(), other.columns());
}

PolarDescriptor::Match PolarDescriptor::match(const Columns& ours, const Columns& other)
{
  Match best;
  for (std::size_t shift = 0; shift < sectors; ++shift)
  {
    // The other vehicle is turned by `shift` sectors: its sector s is our sector s + shift.
    double sum = 0;
    for (std::size_t s = 0; s < sectors; ++s)
    {
      const std::size_t turned = s + shift < sectors ? s + shift : s + shift - sectors;
      sum += static_cast<double>(ours.column[turned].dot(other.column[s]));
    }
    const std::uint64_t seen = rotated(ours.seen, shift) | other.seen;
    const auto used = static_cast<double>(std::bitset<sectors>(seen).count());
    const double distance = used > 0 ? 1 - sum / used : 1;
    if (distance < best.distance)
    {
      best.distance = distance;
      best.heading =
          wrapAngle(2 * M_PI * static_cast<double>(shift) / static_cast<double>(sectors));
    }
  }
  return best;
}

double PolarDescriptor::ringDifference(const RingMeans& a, const RingMeans& b)
{
  double sum = 0;
  for (std::size_t r = 0; r < rings; ++r)
  {
    sum += std::abs(static_cast<double>(a[r] - b[r]));
  }
  return sum / rings;
}

std::string PolarDescriptor::toBytes() const
{
  std::string bytes(reinterpret_cast<const char*>(heights_.data()), heights_.size());
  return bytes.append(reinterpret_cast<const char*>(ring_means_.data()), sizeof ring_means_);
}

PolarDescriptor PolarDescriptor::fromBytes(std::string_view bytes)
{
  PolarDescriptor descriptor;
  takeBytes(bytes, descriptor.heights_);
  takeBytes(bytes, descriptor.ring_means_);
  return descriptor;
}
}  // namespace dyslam
