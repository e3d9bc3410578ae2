// SPDX-License-Identifier: BSD-3-Clause
#include "StreetGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam::sim
{
namespace
{
constexpr double kKerb = 0.12;
constexpr double kCamber = 0.022;

struct Nearest
{
  const Street* street;
  double distance;  // distance to the street's centre line [m]
};

Nearest nearest(const std::vector<Street>& streets, double x)
{
  Nearest best{nullptr, std::numeric_limits<double>::max()};
  for (const auto& s : streets)
  {
    const double d = std::abs(x - s.centre);
    if (d < best.distance)
    {
      best = {&s, d};
    }
  }
  return best;
}
}  // namespace

BlockRing drawBlockRing(double loop_length, double block_size, Rng& rng)
{
  const double quarter = loop_length / 4;
  BlockRing ring;
  ring.u =
      std::max(1, static_cast<int>(std::lround(quarter * rng.uniform(0.85, 1.15) / block_size)));
  ring.v = std::max(1, static_cast<int>(std::lround(loop_length / (2 * block_size))) - ring.u);
  return ring;
}

Street drawTownStreet(Rng& rng)
{
  Street s;
  s.lane = rng.uniform(3.1, 4.2);
  s.parking = rng.chance(0.7) ? 2.2 : 0.0;
  s.walk = rng.uniform(2.0, 6.0);
  s.trees = rng.chance(0.5);
  s.occupancy = rng.uniform(0.2, 0.95);
  return s;
}

StreetGrid::StreetGrid(std::uint64_t seed,
                       int blocks_u,
                       int blocks_v,
                       double block_size,
                       const std::function<Street(Rng&)>& draw)
    : terrain_(seed, 0.035, 0.1), seed_(seed)
{
  Rng rng(combine(seed, 0x57EE7));
  amplitude_u_ = rng.uniform(2, 7);
  amplitude_v_ = rng.uniform(2, 7);
  k_u_ = 6.283185 / rng.uniform(180, 320);
  k_v_ = 6.283185 / rng.uniform(180, 320);
  phase_u_ = rng.uniform(0, 6.28);
  phase_v_ = rng.uniform(0, 6.28);
  const auto addStreets = [&](std::vector<Street>& streets, int blocks)
  {
    double x = -0.5 * blocks * block_size;
    for (int i = 0; i <= blocks; ++i)
    {
      streets.push_back(draw(rng));
      streets.back().centre = x;
      x += block_size * rng.uniform(0.82, 1.18);
    }
  };
  addStreets(along_v, blocks_u);
  addStreets(along_u, blocks_v);
}

Eigen::Vector2d StreetGrid::toWorld(const Eigen::Vector2d& l) const
{
  return {l.x() + amplitude_u_ * std::sin(k_u_ * l.y() + phase_u_),
          l.y() + amplitude_v_ * std::sin(k_v_ * l.x() + phase_v_)};
}

Eigen::Vector2d StreetGrid::toLocal(const Eigen::Vector2d& w) const
{
  Eigen::Vector2d l = w;
  for (int i = 0; i < 12; ++i)
  {
    const Eigen::Vector2d step = w - toWorld(l);
    l += step;
    if (step.squaredNorm() < 1e-16)
    {
      break;
    }
  }
  return l;
}

StreetGrid::Zone StreetGrid::zone(double u, double v) const
{
  const Nearest a = nearest(along_v, u), b = nearest(along_u, v);
  const bool on_a = a.distance < a.street->half(), on_b = b.distance < b.street->half();
  if (on_a || on_b)
  {
    const bool lane_a = a.distance < a.street->carriageway(),
               lane_b = b.distance < b.street->carriageway();
    return lane_a || lane_b || (on_a && on_b) ? Zone::road : Zone::parking;
  }
  if (a.distance < a.street->half() + a.street->walk ||
      b.distance < b.street->half() + b.street->walk)
  {
    return Zone::walk;
  }
  return Zone::block;
}

double StreetGrid::heightLocal(const Eigen::Vector2d& l) const
{
  const Eigen::Vector2d w = toWorld(l);
  const double base = terrain_.height(w.x(), w.y());
  const Nearest a = nearest(along_v, l.x()), b = nearest(along_u, l.y());
  const double inside_a = a.street->half() - a.distance, inside_b = b.street->half() - b.distance;
  if (inside_a > 0 || inside_b > 0)
  {
    return base + kCamber * std::max({inside_a, inside_b, 0.0});
  }
  // Pavements rise a little from the kerb; the blocks behind continue at that height, more uneven.
  const double from_kerb = std::min(-inside_a, -inside_b);
  const double walk = -inside_a < -inside_b ? a.street->walk : b.street->walk;
  const double behind = std::clamp(0.3 * (from_kerb - walk), 0.0, 1.0);
  const double lumps =
      0.06 * static_cast<double>(latticeNoise(static_cast<float>(0.35 * w.x()),
                                              static_cast<float>(0.35 * w.y()), 0.5F));
  return base + kKerb + 0.02 * std::min(from_kerb, walk) + behind * lumps;
}

Material StreetGrid::surface(double u, double v) const
{
  const Nearest a = nearest(along_v, u), b = nearest(along_u, v);
  const auto dash = [](double s) { return s - 9 * std::floor(s / 9) < 3; };
  switch (zone(u, v))
  {
    case Zone::road:
      if ((a.distance < 0.08 && b.distance > b.street->half() + 5 && dash(v)) ||
          (b.distance < 0.08 && a.distance > a.street->half() + 5 && dash(u)))
      {
        return Material::marking;
      }
      return Material::asphalt;
    case Zone::parking:
      return Material::asphalt;
    case Zone::walk:
      return Material::paving;
    case Zone::block:
      break;
  }
  if (paved)
  {
    return Material::paving;
  }
  // Patches of lawn, paving and soil.
  const float patch = latticeNoise(static_cast<float>(0.05 * u), static_cast<float>(0.05 * v),
                                   static_cast<float>(seed_ % 97));
  return patch > 0.15F ? Material::paving : patch < -0.45F ? Material::soil : Material::lawn;
}

Mesh StreetGrid::mesh() const
{
  const auto lines = [](const std::vector<Street>& streets, double low, double high)
  {
    std::vector<double> fixed{low, high};
    for (const auto& s : streets)
    {
      for (const double side : {-1.0, 1.0})
      {
        for (const double d :
             {0.08, s.carriageway(), s.half() - 0.01, s.half() + 0.01, s.half() + s.walk})
        {
          fixed.push_back(s.centre + side * d);
        }
      }
      fixed.push_back(s.centre);
    }
    const auto step = [&streets](double x)
    {
      const Nearest n = nearest(streets, x);
      return n.distance < n.street->half() + n.street->walk ? 1.3 : 2.0;
    };
    return fillLines(fixed, step);
  };
  return gridMesh(*this, lines(along_v, minU(), maxU()), lines(along_u, minV(), maxV()),
                  [this](double u, double v) { return surface(u, v); });
}

std::array<double, 4> StreetGrid::blockKerb(int i, int j) const
{
  const auto edge = [](const std::vector<Street>& s, int index, double side, double outer)
  {
    if (index < 0 || index >= static_cast<int>(s.size()))
    {
      return outer;
    }
    const auto& street = s[static_cast<std::size_t>(index)];
    return street.centre + side * street.half();
  };
  return {edge(along_v, i, 1, minU()), edge(along_u, j, 1, minV()),
          edge(along_v, i + 1, -1, maxU()), edge(along_u, j + 1, -1, maxV())};
}

std::array<double, 4> StreetGrid::blockInside(int i, int j) const
{
  std::array<double, 4> e = blockKerb(i, j);
  const auto walk = [](const std::vector<Street>& s, int index)
  {
    return index < 0 || index >= static_cast<int>(s.size())
               ? 0.0
               : s[static_cast<std::size_t>(index)].walk;
  };
  e[0] += walk(along_v, i);
  e[1] += walk(along_u, j);
  e[2] -= walk(along_v, i + 1);
  e[3] -= walk(along_u, j + 1);
  return e;
}

bool Kerb::isClear(const StreetGrid& grid, double s, double margin) const
{
  const auto& crossing = along_v ? grid.along_u : grid.along_v;
  return std::all_of(crossing.begin(), crossing.end(),
                     [&](const Street& c) { return std::abs(s - c.centre) > c.half() + margin; });
}
}  // namespace dyslam::sim
