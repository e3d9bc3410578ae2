// SPDX-License-Identifier: BSD-3-Clause
// Campus: paths and lawns between large buildings, with a service road around them.
#include <algorithm>
#include <cmath>

#include "OpenGround.h"
#include "Random.h"
#include "World.h"
#include "shapes/Building.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

class CampusBuilder
{
 public:
  CampusBuilder(World& world, Rng& rng, int nx, int ny, double pitch)
      : world_(world), rng_(rng), nx_(nx), ny_(ny), pitch_(pitch), plants_(world, rng)
  {
  }

  P node(int i, int j) const { return nodes_[static_cast<std::size_t>(i * (ny_ + 1) + j)]; }

  void makePaths()
  {
    auto ground = std::make_unique<OpenGround>(world_.seed, 0.04, 0.8, 1.0);
    const P origin(-0.5 * nx_ * pitch_, -0.5 * ny_ * pitch_);
    for (int i = 0; i <= nx_; ++i)
    {
      for (int j = 0; j <= ny_; ++j)
      {
        const double y = j * pitch_ + rng_.uniform(-4, 4), x = i * pitch_ + rng_.uniform(-4, 4);
        nodes_.push_back(origin + P(x, y));
        world_.walks.addNode(nodes_.back());
      }
    }
    const auto id = [&](int i, int j) { return i * (ny_ + 1) + j; };
    const auto link = [&](int a, int b)
    {
      const double width = rng_.uniform(3.0, 5.5);
      world_.walks.addLink(a, b, false, width);
      ground->add(nodes_[static_cast<std::size_t>(a)], nodes_[static_cast<std::size_t>(b)], width,
                  Material::paving);
    };
    for (int i = 0; i <= nx_; ++i)
    {
      for (int j = 0; j <= ny_; ++j)
      {
        if (i < nx_)
        {
          link(id(i, j), id(i + 1, j));
        }
        if (j < ny_)
        {
          link(id(i, j), id(i, j + 1));
        }
      }
    }
    makeRoad(*ground, origin);
    ground_ = ground.get();
    world_.ground = std::move(ground);
    const double margin = 55;
    world_.meshes.push_back(ground_->mesh(origin.x() - margin, origin.y() - margin,
                                          origin.x() + nx_ * pitch_ + margin,
                                          origin.y() + ny_ * pitch_ + margin, 0.9, Material::lawn));
    world_.ego_path = Path(roundedCorners(outerRing(), 3.0, 0.5, true), true);
    world_.loop_length = world_.ego_path.length();
  }

  void furnish()
  {
    world_.meshes.emplace_back();
    for (int i = 0; i < nx_; ++i)
    {
      for (int j = 0; j < ny_; ++j)
      {
        cell(i, j);
      }
    }
    outskirts();
    lampsAndBenches();
  }

 private:
  /** The outermost nodes, which the ego follows one way round or the other. */
  std::vector<P> outerRing()
  {
    std::vector<P> ring;
    for (int i = 0; i < nx_; ++i)
    {
      ring.push_back(node(i, 0));
    }
    for (int j = 0; j < ny_; ++j)
    {
      ring.push_back(node(nx_, j));
    }
    for (int i = nx_; i > 0; --i)
    {
      ring.push_back(node(i, ny_));
    }
    for (int j = ny_; j > 0; --j)
    {
      ring.push_back(node(0, j));
    }
    if (rng_.chance(0.5))
    {
      std::reverse(ring.begin(), ring.end());
    }
    return ring;
  }

  void makeRoad(OpenGround& ground, const P& origin)
  {
    const double out = 15;
    const P low = origin - P(out, out), high = origin + P(nx_ * pitch_ + out, ny_ * pitch_ + out);
    const std::vector<P> ring{low, {high.x(), low.y()}, high, {low.x(), high.y()}};
    ground.add(roundedCorners(ring, 12, 3, true), 6.6, Material::asphalt, true);
    const auto lane = [&](double offset, bool backwards)
    {
      std::vector<P> r{low - P(offset, offset),
                       {high.x() + offset, low.y() - offset},
                       high + P(offset, offset),
                       {low.x() - offset, high.y() + offset}};
      if (backwards)
      {
        std::reverse(r.begin(), r.end());
      }
      Lane l;
      l.path = Path(roundedCorners(r, 12 + (backwards ? -1.5 : 1.5), 1.0, true), true);
      // A closed lane is its own successor; its path must not wrap.
      auto points = l.path.points();
      l.path = Path(points);
      l.next = {static_cast<int>(world_.roads.lanes.size())};
      l.speed_limit = rng_.uniform(5, 7);
      world_.roads.lanes.push_back(l);
    };
    lane(1.6, false);  // anticlockwise traffic drives on the outside
    lane(-1.6, true);
    road_low_ = low;
    road_high_ = high;
  }

  void cell(int i, int j)
  {
    // The largest axis-parallel rectangle clear of the four paths.
    const P a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
    const double margin = rng_.uniform(5, 9);
    const double x0 = std::max(a.x(), d.x()) + margin, x1 = std::min(b.x(), c.x()) - margin;
    const double y0 = std::max(a.y(), b.y()) + margin, y1 = std::min(d.y(), c.y()) - margin;
    if (rng_.chance(0.62) && x1 - x0 > 14 && y1 - y0 > 12)
    {
      BuildingStyle style = drawHall(rng_);
      style.width = static_cast<float>(std::min(static_cast<double>(style.width), x1 - x0));
      style.depth = static_cast<float>(std::min(static_cast<double>(style.depth), y1 - y0));
      building(style, {x0, y0});
      if (y1 - y0 - static_cast<double>(style.depth) > 16 && x1 - x0 > 20)
      {
        // L-shaped building
        BuildingStyle wing = style;
        wing.width = static_cast<float>(rng_.uniform(12, 16));
        wing.depth = static_cast<float>(y1 - y0) - style.depth;
        building(wing, {x0, y0 + static_cast<double>(style.depth)});
      }
      for (int k = 0; k < 5; ++k)
      {
        // Bicycles at the facade
        const double x = rng_.uniform(x0, x1);
        const double yaw = 1.57 + rng_.uniform(-0.2, 0.2);
        world_.park(rng_.pick(world_.parked_bicycles), {x, y0 - 1.2}, yaw, rng_);
      }
    }
    else
    {
      for (int k = 0; k < 9; ++k)
      {
        plant({rng_.uniform(x0, x1), rng_.uniform(y0, y1)}, 0.7);
      }
    }
    for (int k = 0; k < 5; ++k)
    {
      const double y = rng_.uniform(3, pitch_ - 3), x = rng_.uniform(3, pitch_ - 3);
      const P where = a + P(x, y);
      const bool in_building = where.x() > x0 - 1.5 && where.x() < x1 + 1.5 &&
                               where.y() > y0 - 1.5 && where.y() < y1 + 1.5;
      if (!in_building)
      {
        plant(where, 0.5);
      }
    }
  }

  void building(const BuildingStyle& style, const P& corner)
  {
    double z = 1e9;
    for (const double u : {0.0, static_cast<double>(style.width)})
    {
      for (const double v : {0.0, static_cast<double>(style.depth)})
      {
        z = std::min(z, ground_->height(corner + P(u, v)));
      }
    }
    Eigen::Affine3f t = Eigen::Affine3f::Identity();
    t.translate(Eigen::Vector3d(corner.x(), corner.y(), z + 0.1).cast<float>());
    addBuilding(world_.meshes.back(), style, t, rng_);
  }

  void plant(const P& where, double tree_share)
  {
    if (ground_->nearestStrip(where).first < 0.8)
    {
      return;
    }
    const bool tree = rng_.chance(tree_share);
    const auto scale = static_cast<float>(rng_.uniform(0.8, 1.2));
    const double yaw = rng_.uniform(0, 6.28);
    world_.placeOnGround(tree ? rng_.pick(plants_.trees) : rng_.pick(plants_.bushes), where, yaw,
                         scale);
  }

  /** Adds a row of buildings, hedges and trees beyond the service road, and parked vehicles along
   * it. */
  void outskirts()
  {
    const double out = 9;
    const P low = road_low_ - P(out, out), high = road_high_ + P(out, out);
    const auto row = [&](const P& from, const P& along, double length, const P& outward)
    {
      double s = 0;
      while (s < length - 10)
      {
        const double u = rng_.uniform();
        if (u < 0.45)
        {
          BuildingStyle style = drawTownHouse(rng_);
          const double w = static_cast<double>(style.width), d = static_cast<double>(style.depth);
          // Axis-parallel building on the outer side
          const P near = from + s * along + 3 * outward, far = near + w * along + d * outward;
          const P corner(std::min(near.x(), far.x()), std::min(near.y(), far.y()));
          if (std::abs(along.x()) < 0.5)
          {
            std::swap(style.width, style.depth);
          }
          building(style, corner);
          s += w + rng_.uniform(2, 8);
        }
        else if (u < 0.65)
        {
          for (int k = 0; k < 4; ++k, s += 3)
          {
            world_.placeOnGround(plants_.hedges[static_cast<std::size_t>(k % 2)], from + s * along,
                                 std::atan2(along.y(), along.x()));
          }
        }
        else
        {
          for (int k = 0; k < 4; ++k)
          {
            const double off = rng_.uniform(0, 10), forth = s + rng_.uniform(0, 12);
            plant(from + forth * along + off * outward, 0.7);
          }
          s += 12;
        }
      }
    };
    row(low, P(1, 0), high.x() - low.x(), P(0, -1));
    row({high.x(), low.y()}, P(0, 1), high.y() - low.y(), P(1, 0));
    row({low.x(), high.y()}, P(1, 0), high.x() - low.x(), P(0, 1));
    row(low, P(0, 1), high.y() - low.y(), P(-1, 0));
    for (double x = road_low_.x() + 14; x < road_high_.x() - 14; x += rng_.uniform(5.5, 9))
    {
      if (rng_.chance(0.55))
      {
        const double yaw = rng_.uniform(-0.04, 0.04);
        world_.park(drawVehicle(world_, rng_, {0}), {x, road_low_.y() + 4.5}, yaw, rng_);
      }
      if (rng_.chance(0.35))
      {
        const double yaw = 3.14159 + rng_.uniform(-0.04, 0.04);
        world_.park(drawVehicle(world_, rng_, {0}), {x, road_high_.y() - 4.5}, yaw, rng_);
      }
    }
  }

  void lampsAndBenches()
  {
    const int lamp = world_.addShape(makeLampPost(4.2F, 0.4F)),
              bench = world_.addShape(makeBench()), bin = world_.addShape(makeBin());
    const int sign = world_.addShape(makeSign(2)), bollard = world_.addShape(makeBollard());
    for (const auto& link : world_.walks.links)
    {
      const P a = world_.walks.nodes[static_cast<std::size_t>(link.a)],
              b = world_.walks.nodes[static_cast<std::size_t>(link.b)];
      const P d = (b - a).normalized(), r(d.y(), -d.x());
      const double yaw = std::atan2(d.y(), d.x());
      const double off = 0.5 * link.width + 0.6;
      for (double s = rng_.uniform(4, 14); s < (b - a).norm() - 3; s += rng_.uniform(14, 24))
      {
        world_.placeOnGround(lamp, a + s * d + off * r, yaw);
        if (rng_.chance(0.5))
        {
          const double turned = yaw + (rng_.chance(0.5) ? 0 : 3.1416);
          world_.placeOnGround(rng_.chance(0.6) ? bench : bin, a + (s + 3) * d - off * r, turned);
        }
      }
      if (rng_.chance(0.4))
      {
        world_.placeOnGround(rng_.chance(0.5) ? sign : bollard, a + 4 * d + off * r, yaw);
      }
    }
  }

  World& world_;
  Rng& rng_;
  int nx_, ny_;
  double pitch_;
  OpenGroundPlants plants_;
  std::vector<P> nodes_;
  const OpenGround* ground_ = nullptr;
  P road_low_, road_high_;
};
}  // namespace

void buildCampus(World& world, const SimulatorOptions& options)
{
  Rng rng(combine(world.seed, 0xCA3B05));
  const double pitch = rng.uniform(42, 56);
  const int nx = std::max(
      1, static_cast<int>(std::lround(options.loop_length / 4 / pitch * rng.uniform(0.8, 1.2))));
  const int ny = std::max(1, static_cast<int>(std::lround(options.loop_length / 2 / pitch)) - nx);
  CampusBuilder builder(world, rng, nx, ny, pitch);
  builder.makePaths();
  builder.furnish();
}
}  // namespace dyslam::sim
