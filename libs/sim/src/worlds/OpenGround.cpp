// SPDX-License-Identifier: BSD-3-Clause
#include "OpenGround.h"

#include <algorithm>
#include <cmath>

#include "World.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

double distanceToSegment(const P& p, const P& a, const P& b)
{
  const P d = b - a;
  const double t = std::clamp((p - a).dot(d) / std::max(1e-9, d.squaredNorm()), 0.0, 1.0);
  return (a + t * d - p).norm();
}
}  // namespace

OpenGround::OpenGround(std::uint64_t seed, double slope, double bumps, double lumps)
    : terrain_(seed, slope, bumps), lumps_(lumps)
{
}

P OpenGround::toWorld(const P& local) const
{
  return local;
}

P OpenGround::toLocal(const P& world) const
{
  return world;
}

double OpenGround::heightLocal(const P& p) const
{
  const double out = std::clamp(nearestStrip(p).first / 0.25, 0.0, 1.0);
  const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
  const double lump =
      0.05 + lumps_ * (0.07 * static_cast<double>(latticeNoise(0.3F * x, 0.3F * y, 0.5F)) +
                       0.03 * static_cast<double>(latticeNoise(1.1F * x, 1.1F * y, 7.5F)));
  return terrain_.height(p.x(), p.y()) + out * lump;
}

std::pair<double, const OpenGround::Strip*> OpenGround::nearestStrip(const P& p) const
{
  double best = 1e9;
  const Strip* nearest = nullptr;
  for (const auto& s : strips_)
  {
    const double d = distanceToSegment(p, s.a, s.b) - s.half_width;
    if (d < best)
    {
      best = d;
      nearest = &s;
    }
  }
  return {best, nearest};
}

void OpenGround::add(const P& a, const P& b, double width, Material material)
{
  strips_.push_back({a, b, 0.5 * width, material});
}

void OpenGround::add(const std::vector<P>& line, double width, Material material, bool closed)
{
  for (std::size_t i = 0; i + (closed ? 0 : 1) < line.size(); ++i)
  {
    add(line[i], line[(i + 1) % line.size()], width, material);
  }
}

Mesh OpenGround::mesh(double x0, double y0, double x1, double y1, double step, Material field) const
{
  const auto lines = [&](double a, double b) {
    return fillLines({a, b}, [&](double) { return step; });
  };
  const auto material = [&](double x, double y)
  {
    const auto [d, strip] = nearestStrip({x, y});
    return d < 0.1 && strip != nullptr ? strip->material : field;
  };
  return gridMesh(*this, lines(x0, x1), lines(y0, y1), material);
}

OpenGroundPlants::OpenGroundPlants(World& world, Rng& rng)
{
  for (int i = 0; i < 5; ++i)
  {
    trees.push_back(world.addShape(i == 4 ? drawConifer(rng, {6, 12}, {1.5, 2.4})
                                          : drawTree(rng, {5, 13}, {1.6, 3.6}, {1.6, 3.2})));
    bushes.push_back(world.addShape(drawBush(rng, {0.5, 1.4}, {0.6, 1.6})));
  }
  hedges = {world.addShape(makeHedge(rng, 3, 0.8F, 1.0F)),
            world.addShape(makeHedge(rng, 3, 1.0F, 1.6F))};
}
}  // namespace dyslam::sim
