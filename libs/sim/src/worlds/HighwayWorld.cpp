// SPDX-License-Identifier: BSD-3-Clause
// Highway and tunnel along one closed centre line.
#include <algorithm>
#include <cmath>

#include "Random.h"
#include "RoadGround.h"
#include "World.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;
using V = Eigen::Vector3f;
constexpr double kTau = 2 * M_PI;

/** A closed curve of about this length, near a circle, with points at equal distances. */
Path closedCurve(Rng& rng, double length)
{
  const double p2 = rng.uniform(0, kTau), p3 = rng.uniform(0, kTau), a2 = rng.uniform(0.05, 0.16),
               a3 = rng.uniform(0.0, 0.04);
  std::vector<P> points;
  const int count = std::max(120, static_cast<int>(length / 3));
  for (int i = 0; i < count; ++i)
  {
    const double t = kTau * i / count;
    const double r = length / kTau * (1 + a2 * std::sin(2 * t + p2) + a3 * std::sin(3 * t + p3));
    points.emplace_back(r * std::cos(t), r * std::sin(t));
  }
  const Path rough(points, true);
  std::vector<P> even;
  for (int i = 0; i < count; ++i)
  {
    even.push_back(rough.at(rough.length() * i / count).position);
  }
  return Path(even, true);
}

/** Builds the surface and what stands along it. \see RoadGround for the coordinates s and d */
class RoadBuilder
{
 public:
  RoadBuilder(World& world, const RoadGround& ground, Rng& rng, double edge)
      : world_(world), ground_(ground), rng_(rng), edge_(edge), length_(world.highway.length())
  {
  }

  /** \param reach of the ground to both sides of the centre line [m] */
  void surface(double reach)
  {
    const double median = world_.highway_median, w = world_.highway_lane_width;
    const int lanes = world_.highway_lanes;
    const bool tunnel = world_.kind == WorldKind::tunnel;
    std::vector<double> d{-reach, reach};
    for (const double side : {-1.0, 1.0})
    {
      for (int i = 0; i <= lanes; ++i)
      {
        d.push_back(side * (median + i * w - 0.08));
        d.push_back(side * (median + i * w + 0.08));
      }
      d.push_back(side * (edge_ - 0.01));
      d.push_back(side * (edge_ + 0.01));
    }
    const auto step = [&](double x) { return std::abs(x) < edge_ + 6 ? 1.6 : 3.0; };
    std::vector<double> s;
    const int count = static_cast<int>(length_ / 2.4);
    for (int i = 0; i <= count; ++i)
    {
      s.push_back(length_ * i / count);
    }
    const auto material = [&](double u, double v)
    {
      const double a = std::abs(v);
      if (a > edge_)
      {
        return tunnel ? Material::concrete : Material::lawn;
      }
      if (a < median - 0.1)
      {
        return tunnel ? Material::asphalt : Material::lawn;
      }
      for (int i = 0; i <= lanes; ++i)
      {
        if (std::abs(a - median - i * w) < 0.09 && (i == 0 || i == lanes || std::fmod(u, 12) < 5))
        {
          return Material::marking;
        }
      }
      return Material::asphalt;
    };
    world_.meshes.push_back(gridMesh(ground_, s, fillLines(d, step), material));
  }

  V point(double s, double d, double above) const
  {
    const P w = ground_.toWorld({s, d});
    return Eigen::Vector3d(w.x(), w.y(), ground_.heightLocal({s, d}) + above).cast<float>();
  }

  /** A strip of constant profile (offset, height) along the road. */
  void strip(Mesh& mesh,
             double from,
             double to,
             double d,
             const std::vector<std::array<double, 2>>& profile,
             Material material,
             double step = 4)
  {
    for (double s = from; s < to - 0.1; s += step)
    {
      const double e = std::min(to, s + step);
      for (std::size_t i = 0; i + 1 < profile.size(); ++i)
      {
        mesh.addQuad(point(s, d + profile[i][0], profile[i][1]),
                     point(e, d + profile[i][0], profile[i][1]),
                     point(e, d + profile[i + 1][0], profile[i + 1][1]),
                     point(s, d + profile[i + 1][0], profile[i + 1][1]), material);
      }
    }
  }

  void rail(Mesh& mesh, double from, double to, double d)
  {
    strip(mesh, from, to, d,
          {{0.04, 0.44}, {-0.04, 0.52}, {0.04, 0.6}, {-0.04, 0.68}, {0.04, 0.76}},
          Material::guard_rail);
    for (double s = from; s < to; s += 4)
    {
      const V foot = point(s, d + (d > 0 ? 0.12 : -0.12), 0.3);
      addBox(mesh, foot, V(0.1F, 0.1F, 0.8F), Material::guard_rail);
    }
  }

  void barriers(Mesh& mesh)
  {
    const double inner = world_.highway_median - 0.55;
    if (rng_.chance(0.5))
    {
      strip(mesh, 0, length_, 0,
            {{0.3, 0},
             {0.28, 0.1},
             {0.12, 0.3},
             {0.08, 0.85},
             {-0.08, 0.85},
             {-0.12, 0.3},
             {-0.28, 0.1},
             {-0.3, 0}},
            Material::guard_rail, 6);
    }
    else
    {
      rail(mesh, 0, length_, inner);
      rail(mesh, 0, length_, -inner);
    }
    for (const double side : {-1.0, 1.0})
    {
      for (double s = 0; s < length_ - 40;)
      {
        const double run = std::min(rng_.uniform(60, 260), length_ - s);
        const double u = rng_.uniform();
        if (u < 0.45)
        {
          rail(mesh, s, s + run, side * (edge_ + 0.5));
        }
        else if (u < 0.6)
        {
          const double high = rng_.uniform(2.5, 4.5);
          strip(mesh, s, s + run, side * (edge_ + 2.5),
                {{-0.1, -1}, {-0.1, high}, {0.1, high}, {0.1, -1}},
                rng_.chance(0.5) ? Material::wood_fence : Material::concrete);
          for (double p = s; p < s + run; p += 4)
          {
            addBox(mesh, point(p, side * (edge_ + 2.5), 0.5 * high),
                   V(0.3F, 0.3F, static_cast<float>(high + 1)), Material::guard_rail);
          }
        }
        s += run + (rng_.chance(0.5) ? rng_.uniform(20, 200) : 0);
      }
    }
  }

  void gantry(Mesh& mesh, double s)
  {
    for (const double d : {-edge_ - 1.0, edge_ + 1.0})
    {
      addTube(mesh, point(s, d, -0.5), point(s, d, 7), 0.18F, 0.18F, 8, Material::steel);
    }
    const V a = point(s, -edge_ - 1.0, 6.8), b = point(s, edge_ + 1.0, 6.8);
    addTube(mesh, a, b, 0.15F, 0.15F, 6, Material::steel);
    for (const double d : {-edge_ + 2.0, -edge_ + 7.0, edge_ - 5.0})
    {
      mesh.addQuad(point(s, d, 5.6), point(s, d + 4, 5.6), point(s, d + 4, 7.6), point(s, d, 7.6),
                   Material::sign_face);
    }
  }

  void roadside()
  {
    std::vector<int> trees, bushes;
    for (int i = 0; i < 4; ++i)
    {
      trees.push_back(world_.addShape(i == 3 ? drawConifer(rng_, {6, 12}, {1.5, 2.4})
                                             : drawTree(rng_, {6, 11}, {1.8, 3.2}, {1.5, 3})));
      bushes.push_back(world_.addShape(drawBush(rng_, {0.7, 1.6}, {0.8, 2.2})));
    }
    const int post = world_.addShape(makeBollard()), sign = world_.addShape(makeSign(3)),
              small_sign = world_.addShape(makeSign(2));
    const auto put = [&](int shape, double s, double d, float scale) {
      world_.placeOnGround(shape, ground_.toWorld({s, d}), rng_.uniform(0, 6.28), scale);
    };
    for (const double side : {-1.0, 1.0})
    {
      for (double s = 0; s < length_; s += 50)
      {
        put(post, s, side * (edge_ + 0.9), 1);
      }
      for (double s = rng_.uniform(0, 100); s < length_; s += rng_.uniform(80, 350))
      {
        put(rng_.chance(0.4) ? sign : small_sign, s, side * (edge_ + 1.8), 1.2F);
      }
      // Stands of trees with long empty stretches between them.
      for (double s = 0; s < length_;)
      {
        const double run = rng_.uniform(50, 250);
        const double density = rng_.chance(0.45) ? rng_.uniform(0.05, 0.25) : 0.0;
        for (double t = s; t < std::min(length_, s + run) && density > 0;
             t += rng_.uniform(0.5, 1.5) / density)
        {
          const bool tree = rng_.chance(0.5);
          const auto scale = static_cast<float>(rng_.uniform(0.8, 1.3));
          const double off = edge_ + rng_.uniform(6, 26);
          put(tree ? trees[static_cast<std::size_t>(rng_.below(4))]
                   : bushes[static_cast<std::size_t>(rng_.below(4))],
              t, side * off, scale);
        }
        s += run;
      }
    }
  }

  /** Vault, lamps, niches, doors and cables of a tunnel. */
  void vault(Mesh& mesh)
  {
    const double half = edge_ + 1.0;
    const double spring = 3.2, rise = rng_.uniform(2.6, 4.0);
    std::vector<std::array<double, 2>> profile{{half, -0.5}, {half, 1.2}, {half + 0.05, spring}};
    for (int i = 1; i <= 12; ++i)
    {
      const double t = kTau / 2 * i / 12;
      profile.push_back({(half + 0.05) * std::cos(t), spring + rise * std::sin(t)});
    }
    profile.push_back({-half, 1.2});
    profile.push_back({-half, -0.5});
    strip(mesh, 0, length_, 0, profile, Material::concrete, 3);
    for (const double side : {-1.0, 1.0})
    {
      strip(mesh, 0, length_, side * (half - 0.12),
            {{-0.1, 2.4}, {0.1, 2.4}, {0.1, 2.5}, {-0.1, 2.5}, {-0.1, 2.4}}, Material::steel, 6);
      for (double s = rng_.uniform(0, 20); s < length_ - 3; s += rng_.uniform(35, 90))
      {
        const V c = point(s, side * (half - 0.15), 1.1);
        addBox(mesh, c, V(1.0F, 0.6F, 2.1F),
               rng_.chance(0.5) ? Material::furniture : Material::steel);
      }
      for (double s = 5; s < length_; s += 12)
      {
        addBox(mesh, point(s, side * 0.55 * half, spring + 0.75 * rise), V(0.9F, 0.5F, 0.25F),
               Material::steel);
      }
    }
    for (double s = 40; s < length_; s += rng_.uniform(90, 160))
    {
      addTube(mesh, point(s, 0, spring + rise - 0.8), point(s + 3, 0, spring + rise - 0.8), 0.6F,
              0.6F, 12, Material::steel);
    }
  }

 private:
  World& world_;
  const RoadGround& ground_;
  Rng& rng_;
  double edge_;
  double length_;
};
}  // namespace

void buildHighway(World& world, const SimulatorOptions& options)
{
  Rng rng(combine(world.seed, 0x419414));
  const bool tunnel = options.world == WorldKind::tunnel;
  world.highway = closedCurve(rng, std::max(options.loop_length, 1500.0));
  world.loop_length = world.highway.length();
  world.highway_lanes = tunnel ? 2 : 2 + rng.below(3);
  world.highway_median = tunnel ? 0.25 : rng.uniform(1.4, 3.0);
  world.highway_lane_width = rng.uniform(3.4, 3.75);
  const double edge = world.highway_median + world.highway_lanes * world.highway_lane_width +
                      (tunnel ? 0.8 : rng.uniform(1.0, 3.2));
  auto ground = std::make_unique<RoadGround>(world.seed, world.highway, edge, tunnel);
  RoadBuilder builder(world, *ground, rng, edge);
  world.ground = std::move(ground);
  builder.surface(tunnel ? edge + 1.2 : edge + 42);
  Mesh fixed;
  if (tunnel)
  {
    builder.vault(fixed);
  }
  else
  {
    builder.barriers(fixed);
    for (double s = rng.uniform(50, 400); s < world.loop_length; s += rng.uniform(350, 900))
    {
      builder.gantry(fixed, s);
    }
    builder.roadside();
  }
  world.meshes.push_back(std::move(fixed));
}
}  // namespace dyslam::sim
