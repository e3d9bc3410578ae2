// SPDX-License-Identifier: BSD-3-Clause
// Blocks of a downtown world: houses with shops, alleys and courtyards.
#include <algorithm>
#include <cmath>

#include "BlockSide.h"
#include "Downtown.h"
#include "shapes/ShopHouse.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

/** Builds the sides of blocks. */
class DowntownBlockBuilder
{
 public:
  explicit DowntownBlockBuilder(Downtown& town)
      : town_(town), world_(town.world), grid_(town.grid), rng_(town.rng), shapes_(town.shapes)
  {
  }

  /** Builds one house, alley or courtyard beside the other. */
  void build(const Side& side)
  {
    double s = 0;
    while (s < side.length - 3)
    {
      const double left = side.length - s;
      const double u = rng_.uniform();
      if (!town_.near(side.at(s, 0)))
      {
        s += distantHouse(side, s, std::min(left, rng_.uniform(8, 16)));
      }
      else if (u < 0.13 && left > 8)
      {
        s += alley(side, s);
      }
      else if (u < 0.20 && left > 14)
      {
        s += courtyard(side, s);
      }
      else
      {
        s += house(side, s, left);
      }
    }
  }

 private:
  Eigen::Affine3f frame(const Side& side, double s, double front, double width, double depth) const
  {
    return houseFrame(grid_, side, s, front, width, depth);
  }

  // The following add what stands from s on along a side, and return the length that it takes [m].

  /** A house of which the ego sees little: walls only. */
  double distantHouse(const Side& side, double s, double width)
  {
    const double depth = side.depth - 2, front = rng_.chance(0.6) ? 0 : rng_.uniform(0, 2);
    const float top = static_cast<float>(rng_.uniform(4, 17));
    Mesh box;
    addBox(box,
           Eigen::Vector3f(static_cast<float>(0.5 * width), static_cast<float>(0.5 * depth),
                           0.5F * top - 0.75F),
           Eigen::Vector3f(static_cast<float>(width), static_cast<float>(depth), top + 1.5F),
           Material::plaster);
    world_.meshes.back().append(box, frame(side, s, front, width, depth));
    return width;
  }

  /** A house with shops. \param left length of the side that is left [m] */
  double house(const Side& side, double s, double left)
  {
    ShopHouseStyle style = drawShopHouse(rng_);
    const double drawn = static_cast<double>(style.width);
    const double width = left - drawn < 3 ? left : drawn;
    style.width = static_cast<float>(width);
    const double u = rng_.uniform();
    // A little behind the line of its neighbours, or behind a yard
    const double front = u < 0.55 ? 0.05 : u < 0.82 ? rng_.uniform(0.2, 1.5) : rng_.uniform(2, 4);
    style.projection = front > 1.5 ? 0 : style.projection;
    style.depth =
        static_cast<float>(std::min(static_cast<double>(style.depth), side.depth - front));
    addShopHouse(world_.meshes.back(), style,
                 frame(side, s, front, width, static_cast<double>(style.depth)), rng_);
    if (front >= 2)
    {
      yard(side, s, width, front);
    }
    return width;
  }

  /** An alley into the block. */
  double alley(const Side& side, double s)
  {
    const double width = rng_.uniform(2, 5), length = rng_.uniform(15, 40);
    addAlley(world_.meshes.back(), static_cast<float>(width), static_cast<float>(length),
             frame(side, s, 0.4, width, 4), rng_);
    const int things = rng_.below(6);
    for (int k = 0; k < things; ++k)
    {
      const double y = rng_.uniform(1.5, 0.8 * length);
      const double x = rng_.chance(0.5) ? 0.5 : width - 0.5;
      yardThing(side.at(s + x, y));
    }
    return width;
  }

  /** A yard behind a wall with an open gate, and a house with hardly any shop at its back. */
  double courtyard(const Side& side, double s)
  {
    const double width = rng_.uniform(9, 13), deep = rng_.uniform(8, 15);
    const double gate_width = rng_.uniform(2.5, 4.5), gate = rng_.uniform(0.5, width - 5);
    const float height = static_cast<float>(rng_.uniform(1.0, 2.8));
    addGateWall(world_.meshes.back(), static_cast<float>(width), height, static_cast<float>(gate),
                static_cast<float>(gate_width), frame(side, s, 0.2, width, 4));
    ShopHouseStyle style = drawShopHouse(rng_);
    style.width = static_cast<float>(width);
    style.depth = 8;
    style.open = 0.1F;
    style.signs = 0;
    style.projection = 0;
    addShopHouse(world_.meshes.back(), style, frame(side, s, deep, width, 8), rng_);
    const int things = 2 + rng_.below(8);
    for (int k = 0; k < things; ++k)
    {
      const double x = rng_.uniform(0.6, width - 0.6), y = rng_.uniform(1.5, deep - 3);
      yardThing(side.at(s + x, y));
    }
    if (rng_.chance(0.5))
    {
      const double x = rng_.uniform(2, width - 2);
      const P a = grid_.toWorld(side.at(s + x, 2)), b = grid_.toWorld(side.at(s + x, 7));
      world_.park(rng_.pick(world_.cars), 0.5 * (a + b), std::atan2(b.y() - a.y(), b.x() - a.x()),
                  rng_);
    }
    return width;
  }

  /** Between the pavement and a house that stands back: a fence with a gap, scooters, goods. */
  void yard(const Side& side, double s, double width, double front)
  {
    if (rng_.chance(0.5))
    {
      const int fence = rng_.pick(shapes_.fences);
      const double gap = rng_.uniform(0, width);
      for (double x = 0; x + 3 <= width; x += 3)
      {
        if (std::abs(x + 1.5 - gap) > 1.5)
        {
          fenceElement(side, s + x, 0.3, fence);
        }
      }
    }
    const int things = rng_.below(5);
    for (int k = 0; k < things; ++k)
    {
      const double x = rng_.uniform(0.5, width - 0.5), y = rng_.uniform(0.9, front - 0.5);
      yardThing(side.at(s + x, y));
    }
  }

  /** Three metres of a fence from s on. */
  void fenceElement(const Side& side, double s, double inward, int fence)
  {
    const P a = grid_.toWorld(side.at(s, inward)), b = grid_.toWorld(side.at(s + 3, inward));
    world_.placeOnGround(fence, a, std::atan2(b.y() - a.y(), b.x() - a.x()));
  }

  /** A scooter, goods, an umbrella, a rack, a bush or a bin. */
  void yardThing(const P& local)
  {
    const double u = rng_.uniform(), turned = rng_.uniform(0, 6.28);
    if (u < 0.45)
    {
      town_.placeScooter(local, turned);
      return;
    }
    world_.placeOnGround(u < 0.6   ? rng_.pick(shapes_.goods)
                         : u < 0.7 ? rng_.pick(shapes_.umbrellas)
                         : u < 0.8 ? rng_.pick(shapes_.racks)
                         : u < 0.9 ? rng_.pick(shapes_.bushes)
                                   : rng_.pick(shapes_.clutter),
                         grid_.toWorld(local), turned);
  }

  Downtown& town_;
  World& world_;
  const StreetGrid& grid_;
  Rng& rng_;
  const DowntownShapes& shapes_;
};
}  // namespace

void addDowntownBlock(Downtown& town, int i, int j)
{
  constexpr double kDepth = 17;  // of houses and yards [m]
  DowntownBlockBuilder builder(town);
  for (const Side& side : blockSides(town.grid, i, j, kDepth))
  {
    builder.build(side);
  }
}
}  // namespace dyslam::sim
