// SPDX-License-Identifier: BSD-3-Clause
#include "RoadGround.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "Random.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;
}  // namespace

RoadGround::RoadGround(std::uint64_t seed, Path path, double edge, bool tunnel)
    : terrain_(seed, tunnel ? 0.015 : 0.025, 0.1),
      path_(std::move(path)),
      edge_(edge),
      tunnel_(tunnel)
{
  Rng rng(combine(seed, 0x41D));
  for (auto& p : phase_)
  {
    p = rng.uniform(0, 2 * M_PI);
  }
  for (std::size_t i = 0; i + 1 < path_.points().size(); ++i)
  {
    s_.push_back(i == 0 ? 0 : s_.back() + (path_.points()[i] - path_.points()[i - 1]).norm());
    buckets_[key(path_.points()[i])].push_back(static_cast<int>(i));
  }
}

P RoadGround::toWorld(const P& local) const
{
  const auto at = path_.at(local.x());
  return at.position + local.y() * P(-std::sin(at.heading), std::cos(at.heading));
}

P RoadGround::toLocal(const P& world) const
{
  const int i = nearest(world);
  const auto n = static_cast<int>(s_.size());
  const P a = path_.points()[static_cast<std::size_t>((i + n - 1) % n)],
          b = path_.points()[static_cast<std::size_t>((i + 1) % n)];
  const P d = (b - a).normalized();
  const P offset = world - path_.points()[static_cast<std::size_t>(i)];
  return {s_[static_cast<std::size_t>(i)] + d.dot(offset), d.x() * offset.y() - d.y() * offset.x()};
}

double RoadGround::heightLocal(const P& l) const
{
  const P w = toWorld(l);
  return terrain_.height(w.x(), w.y()) + profile(l.x(), l.y());
}

double RoadGround::profile(double s, double d) const
{
  const double a = std::abs(d);
  double z = -0.025 * std::min(a, edge_);
  if (tunnel_)
  {
    return a > edge_ ? z + 0.15 : z;
  }
  if (a > edge_)
  {
    // A ditch, then an embankment or a downward slope that varies along the road.
    const double out = a - edge_;
    const double side = d > 0 ? 0 : 2.1;
    const double k = 2 * M_PI / path_.length();
    const double bank =
        2.2 * std::sin(std::round(path_.length() / 310) * k * s + phase_[0] + side) +
        1.2 * std::sin(std::round(path_.length() / 120) * k * s + phase_[1] + side);
    const double t = std::clamp((out - 2.0) / 14, 0.0, 1.0);
    z += -0.35 * std::exp(-(out - 2.0) * (out - 2.0) / 1.2) + bank * t * t * (3 - 2 * t);
    z += 0.07 * t *
         static_cast<double>(
             latticeNoise(static_cast<float>(0.4 * s), static_cast<float>(0.4 * d), 3.3F));
  }
  return z;
}

long RoadGround::key(const P& p)
{
  return (std::lround(std::floor(p.x() / 40)) + 5000) * 100000 +
         std::lround(std::floor(p.y() / 40)) + 5000;
}

int RoadGround::nearest(const P& w) const
{
  double best = 1e18;
  int index = 0;
  for (int dx = -1; dx <= 1; ++dx)
  {
    for (int dy = -1; dy <= 1; ++dy)
    {
      const auto found = buckets_.find(key(w + 40 * P(dx, dy)));
      if (found == buckets_.end())
      {
        continue;
      }
      for (const int i : found->second)
      {
        const double d = (path_.points()[static_cast<std::size_t>(i)] - w).squaredNorm();
        if (d < best)
        {
          best = d;
          index = i;
        }
      }
    }
  }
  return index;
}
}  // namespace dyslam::sim
