// SPDX-License-Identifier: BSD-3-Clause
#include "PolarDescriptor.h"

#include <algorithm>
#include <cmath>

#include "GroundHeight.h"

namespace dyslam
{
namespace
{
constexpr float height_step = 1.0F / 16;

using Column = Eigen::Matrix<float, PolarDescriptor::rings, 1>;
}  // namespace

PolarDescriptor::PolarDescriptor(const std::vector<Eigen::Vector3f>& points, double max_range)
{
  const float ground = groundHeight(points, 20);
  const auto ring_width = static_cast<float>(max_range / static_cast<double>(rings));
  for (const Eigen::Vector3f& p : points)
  {
    const float range = p.head<2>().norm();
    if (!p.allFinite() || range >= static_cast<float>(max_range) || range < 1e-3F)
    {
      continue;
    }
    const auto ring = std::min(rings - 1, static_cast<std::size_t>(range / ring_width));
    const double turn = std::atan2(p.y(), p.x()) / (2 * M_PI);
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

PolarDescriptor::Match PolarDescriptor::match(const PolarDescriptor& other) const
{
  std::array<Column, sectors> a;
  std::array<Column, sectors> b;
  const auto normalise = [](const PolarDescriptor& d, std::array<Column, sectors>& columns)
  {
    for (std::size_t s = 0; s < sectors; ++s)
    {
      for (std::size_t r = 0; r < rings; ++r)
      {
        columns[s][static_cast<Eigen::Index>(r)] = static_cast<float>(d.heights_[s * rings + r]);
      }
      const float norm = columns[s].norm();
      if (norm > 0)
      {
        columns[s] /= norm;
      }
    }
  };
  normalise(*this, a);
  normalise(other, b);
  Match best;
  for (std::size_t shift = 0; shift < sectors; ++shift)
  {
    double sum = 0;
    int used = 0;
    for (std::size_t s = 0; s < sectors; ++s)
    {
      // Other's vehicle turned by `shift` sectors: what it sees in sector s, we see in s + shift.
      const Column& ours = a[(s + shift) % sectors];
      const bool seen = !ours.isZero(0) || !b[s].isZero(0);
      used += seen ? 1 : 0;
      sum += static_cast<double>(ours.dot(b[s]));
    }
    const double distance = used > 0 ? 1 - sum / used : 1;
    if (distance < best.distance)
    {
      best.distance = distance;
      best.heading = std::remainder(
          2 * M_PI * static_cast<double>(shift) / static_cast<double>(sectors), 2 * M_PI);
    }
  }
  return best;
}

double PolarDescriptor::ringDifference(const PolarDescriptor& other) const
{
  double sum = 0;
  for (std::size_t r = 0; r < rings; ++r)
  {
    sum += std::abs(static_cast<double>(ring_means_[r] - other.ring_means_[r]));
  }
  return sum / rings;
}
}  // namespace dyslam
