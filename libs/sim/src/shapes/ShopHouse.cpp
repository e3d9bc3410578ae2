// SPDX-License-Identifier: BSD-3-Clause
#include "ShopHouse.h"

#include <cmath>

#include "Building.h"

namespace dyslam::sim
{
namespace
{
using V = Eigen::Vector3f;

constexpr float kBase = -1.5F;  // walls begin below the ground, for slopes [m]

/** A wall between two points on the ground. */
void addWall(Mesh& mesh,
             const Eigen::Vector2f& from,
             const Eigen::Vector2f& to,
             float z0,
             float z1,
             Material wall)
{
  mesh.addQuad(V(from.x(), from.y(), z0), V(to.x(), to.y(), z0), V(to.x(), to.y(), z1),
               V(from.x(), from.y(), z1), wall);
}

/** Shelves with goods along the wall x = 0. \param side 1 if they stand on its side of +x, else -1
 */
void addShelves(Mesh& mesh, float y0, float y1, float height, Rng& rng, float side)
{
  const float reach = rng.uniformFloat(0.3, 0.5);
  for (float y = y0; y < y1 - 0.5F;)
  {
    const float length = std::min(rng.uniformFloat(0.7, 1.4), y1 - y);
    const float top = std::min(height - 0.2F, rng.uniformFloat(0.9, 2.3));
    const float middle = y + 0.5F * length;
    // Boards with goods on them, in front of the wall
    for (float z = 0.1F; z < top; z += rng.uniformFloat(0.35, 0.5))
    {
      addBox(mesh, V(side * 0.5F * reach, middle, z), V(reach, length, 0.03F), Material::furniture);
      const float filled = rng.uniformFloat(0.4, 0.95) * length,
                  tall = rng.uniformFloat(0.12, 0.33);
      addBox(mesh, V(side * 0.45F * reach, y + 0.5F * filled, z + 0.5F * tall),
             V(0.8F * reach, filled, tall), Material::furniture);
    }
    for (const float post : {y + 0.02F, y + length - 0.02F})
    {
      addBox(mesh, V(side * reach, post, 0.5F * top), V(0.03F, 0.03F, top), Material::furniture);
    }
    y += length + (rng.chance(0.2) ? 0.7F : 0.0F);
  }
}

/** What stands in a room that is open at y = 0: shelves along the side walls, a partition, a
 * counter, boxes. \param width, depth, height of the room [m] */
void addShopInterior(Mesh& mesh, float width, float depth, float height, Rng& rng)
{
  const auto at = [&](float x, float y, const Mesh& part)
  {
    Eigen::Affine3f t = Eigen::Affine3f::Identity();
    t.translate(V(x, y, 0));
    mesh.append(part, t);
  };
  for (const float side : {1.0F, -1.0F})
  {
    if (rng.chance(0.7))
    {
      Mesh shelves;
      addShelves(shelves, rng.uniformFloat(0.1, 0.8), depth - 0.1F, height, rng, side);
      at(side > 0 ? 0.02F : width - 0.02F, 0, shelves);
    }
  }
  if (rng.chance(0.5))  // a partition before the back wall
  {
    const float y = depth * rng.uniformFloat(0.5, 0.8), wide = width * rng.uniformFloat(0.3, 0.6);
    const float x = rng.chance(0.5) ? 0 : width - wide;
    addWall(mesh, {x, y}, {x + wide, y}, 0, height, Material::plaster);
  }
  if (rng.chance(0.6))  // a counter
  {
    const float wide = width * rng.uniformFloat(0.3, 0.6),
                x = rng.uniformFloat(0.5, 0.5 + 0.4 * width);
    addBox(
        mesh,
        V(std::min(x + 0.5F * wide, width - 0.5F * wide), depth * rng.uniformFloat(0.3, 0.7), 0.5F),
        V(wide, 0.6F, 1.0F), Material::furniture);
  }
  const int boxes = rng.below(9);
  for (int k = 0; k < boxes; ++k)
  {
    const float size = rng.uniformFloat(0.3, 0.8), tall = rng.uniformFloat(0.3, 1.5);
    const float x = rng.uniformFloat(0.5, width - 0.5), y = rng.uniformFloat(0.3, depth - 0.4);
    addBox(mesh, V(x, y, 0.5F * tall), V(size, size, tall), Material::furniture);
  }
  const int hanging = rng.below(5);
  for (int k = 0; k < hanging; ++k)
  {
    const float tall = rng.uniformFloat(0.3, 0.9), x = rng.uniformFloat(0.3, width - 0.3),
                y = rng.uniformFloat(0.1, 0.6 * depth);
    addBox(mesh, V(x, y, height - 0.5F * tall), V(rng.uniformFloat(0.05, 0.5), 0.06F, tall),
           Material::furniture);
  }
}

/** A shop, an entrance or a closed front between x = 0 and `width` in the plane y = 0, up to
 * `height`. */
class Unit
{
 public:
  Unit(Mesh& mesh, float width, float height, Material wall, Rng& rng)
      : mesh_(mesh), width_(width), height_(height), wall_(wall), rng_(rng)
  {
  }

  void addOpenShop(float depth)
  {
    const float jamb = rng_.uniformFloat(0.12, 0.35), lintel = rng_.uniformFloat(2.5, 3.0);
    frame(jamb, lintel);
    addWall(mesh_, {jamb, 0}, {jamb, depth}, kBase, lintel + 0.1F, wall_);
    addWall(mesh_, {width_ - jamb, 0}, {width_ - jamb, depth}, kBase, lintel + 0.1F, wall_);
    addWall(mesh_, {jamb, depth}, {width_ - jamb, depth}, kBase, lintel + 0.1F, wall_);
    mesh_.addQuad(V(jamb, 0, lintel + 0.1F), V(width_ - jamb, 0, lintel + 0.1F),
                  V(width_ - jamb, depth, lintel + 0.1F), V(jamb, depth, lintel + 0.1F), wall_);
    Mesh interior;
    addShopInterior(interior, width_ - 2 * jamb, depth, lintel, rng_);
    Eigen::Affine3f t = Eigen::Affine3f::Identity();
    t.translate(V(jamb, 0, 0));
    mesh_.append(interior, t);
  }

  void addEntrance(float depth)
  {
    const float half = std::min(rng_.uniformFloat(0.6, 1.3), 0.4F * width_);
    addOpening(mesh_, {0, width_, kBase, height_},
               {0.5F * width_ - half, 0.5F * width_ + half, 0.02F, rng_.uniformFloat(2.2, 2.6)},
               depth, wall_, Material::furniture);
  }

  void addClosed(bool glass)
  {
    const float sill = glass && rng_.chance(0.5) ? 0.5F : 0.05F;
    const float lintel = rng_.uniformFloat(2.4, 2.9), recess = rng_.uniformFloat(0.1, 0.6);
    addOpening(mesh_, {0, width_, kBase, height_}, {0.2F, width_ - 0.2F, sill, lintel}, recess,
               wall_, glass ? Material::window : Material::furniture);
  }

 private:
  /** The wall around an opening that reaches to the ground. */
  void frame(float jamb, float lintel)
  {
    addBox(mesh_, V(0.5F * jamb, 0.1F, 0.5F * (kBase + height_)), V(jamb, 0.2F, height_ - kBase),
           wall_);
    addBox(mesh_, V(width_ - 0.5F * jamb, 0.1F, 0.5F * (kBase + height_)),
           V(jamb, 0.2F, height_ - kBase), wall_);
    addBox(mesh_, V(0.5F * width_, 0.1F, 0.5F * (lintel + height_)),
           V(width_ - 2 * jamb, 0.2F, height_ - lintel), wall_);
  }

  Mesh& mesh_;
  float width_, height_;
  Material wall_;
  Rng& rng_;
};

/** Awning and sign boards of a unit that begins at x. */
void addUnitDetails(Mesh& mesh, const ShopHouseStyle& s, float x, float width, bool shop, Rng& rng)
{
  const float front = -s.projection;
  const float awning = s.awning * rng.uniformFloat(0.7, 1.1);
  if (shop && awning > 0.3F && rng.chance(0.6))
  {
    const float high = s.arcade > 0 ? s.ground_floor - 0.2F : std::min(s.ground_floor, 3.1F),
                low = std::max(2.25F, high - rng.uniformFloat(0.2, 0.7));
    mesh.addQuad(V(x + 0.1F, 0, high), V(x + width - 0.1F, 0, high),
                 V(x + width - 0.1F, -awning, low), V(x + 0.1F, -awning, low), Material::roof);
    mesh.addQuad(V(x + 0.1F, -awning, low), V(x + width - 0.1F, -awning, low),
                 V(x + width - 0.1F, -awning, low - 0.15F), V(x + 0.1F, -awning, low - 0.15F),
                 Material::roof);
  }
  if (shop)  // a board above the shop, along the front
  {
    const float tall = rng.uniformFloat(0.5, 1.1);
    addBox(mesh, V(x + 0.5F * width, front - 0.12F, s.ground_floor - 0.1F + 0.5F * tall),
           V(0.9F * width, 0.2F, tall), Material::furniture);
  }
  if (rng.chance(static_cast<double>(s.signs)))
  {
    const float out = rng.uniformFloat(0.6, 1.7), z0 = rng.uniformFloat(2.6, 4.0),
                tall = rng.uniformFloat(0.7, 2.4);
    const float at = x + width * rng.uniformFloat(0.1, 0.9);
    addBox(mesh, V(at, front - 0.15F - 0.5F * out, z0 + 0.5F * tall), V(0.16F, out, tall),
           Material::furniture);
    addBox(mesh, V(at, front - 0.5F * out, z0 + 0.85F * tall), V(0.05F, out + 0.2F, 0.05F),
           Material::steel);
  }
}

void addGroundFloor(Mesh& mesh, const ShopHouseStyle& s, Rng& rng)
{
  const int units = std::max(1, static_cast<int>(std::lround(s.width / s.unit)));
  const float width = s.width / static_cast<float>(units);
  for (int k = 0; k < units; ++k)
  {
    const float x = width * static_cast<float>(k);
    Mesh part;
    Unit unit(part, width, s.ground_floor, s.wall, rng);
    const double kind = rng.uniform();
    const bool shop = kind < static_cast<double>(s.open);
    if (shop)
    {
      unit.addOpenShop(std::min(rng.uniformFloat(2, 6), s.depth - s.arcade - 0.5F));
    }
    else if (kind < static_cast<double>(s.open) + 0.15)
    {
      unit.addEntrance(rng.uniformFloat(0.5, 2.5));
    }
    else
    {
      unit.addClosed(rng.chance(0.5));
    }
    Eigen::Affine3f t = Eigen::Affine3f::Identity();
    t.translate(V(x, s.arcade, 0));
    mesh.append(part, t);
    addUnitDetails(mesh, s, x, width, shop || rng.chance(0.3), rng);
    if (s.arcade > 0)
    {
      for (const float pillar : {x + 0.22F, x + width - 0.22F})
      {
        addBox(mesh, V(pillar, 0.22F, 0.5F * (kBase + s.ground_floor)),
               V(0.4F, 0.4F, s.ground_floor - kBase), s.wall);
      }
    }
  }
  // Ceiling of the arcade and underside of the projection
  mesh.addQuad(V(0, -s.projection, s.ground_floor), V(s.width, -s.projection, s.ground_floor),
               V(s.width, s.arcade + 0.2F, s.ground_floor), V(0, s.arcade + 0.2F, s.ground_floor),
               s.wall);
}

/** Walls of the floors above the shops, in the plane y = 0, with windows, balconies, loggias and
 * air conditioners. */
void addUpperFloors(Mesh& mesh, const ShopHouseStyle& s, Rng& rng)
{
  const int bays = std::max(1, static_cast<int>(std::lround(s.width / 2.6F)));
  const float bay = s.width / static_cast<float>(bays);
  const bool panel = rng.chance(0.5);
  const float recess = rng.chance(0.25) ? rng.uniformFloat(0.6, 1.3) : rng.uniformFloat(0.08, 0.3);
  const float half = 0.5F * std::min(rng.uniformFloat(0.9, 2.0), 0.8F * bay);
  for (int f = 1; f < s.floors; ++f)
  {
    const float z0 = s.ground_floor + s.floor_height * static_cast<float>(f - 1),
                z1 = z0 + s.floor_height;
    for (int b = 0; b < bays; ++b)
    {
      const float x0 = bay * static_cast<float>(b), mid = x0 + 0.5F * bay;
      const bool balcony = rng.chance(static_cast<double>(s.balconies));
      addOpening(mesh, {x0, x0 + bay, z0, z1},
                 {mid - half, mid + half, z0 + (balcony ? 0.15F : 0.9F), z1 - 0.5F}, recess, s.wall,
                 Material::window);
      if (balcony)
      {
        addBalcony(mesh, mid, z0 + 0.02F, bay - 0.1F, panel, s.wall);
      }
      else if (rng.chance(0.3))  // air conditioner
      {
        addBox(mesh, V(mid, -0.25F, z0 + 0.55F), V(0.85F, 0.4F, 0.6F), Material::furniture);
      }
      else if (rng.chance(0.15))  // grille in front of the window
      {
        for (float x = mid - half; x < mid + half; x += 0.15F)
        {
          addBox(mesh, V(x, -0.35F, 0.5F * (z0 + z1)), V(0.02F, 0.02F, 1.5F), Material::steel);
        }
      }
    }
  }
}
}  // namespace

ShopHouseStyle drawShopHouse(Rng& rng)
{
  ShopHouseStyle s;
  s.width = rng.uniformFloat(4, 13);
  s.depth = rng.uniformFloat(11, 16);
  s.floors = 1 + rng.below(5);
  s.ground_floor = rng.uniformFloat(3.2, 4.3);
  s.floor_height = rng.uniformFloat(2.7, 3.3);
  s.arcade = rng.chance(0.35) ? rng.uniformFloat(2.2, 3.6) : 0.0F;
  s.projection = rng.chance(0.35) ? rng.uniformFloat(0.4, 1.3) : 0.0F;
  s.unit = rng.uniformFloat(3, 5.5);
  s.open = rng.uniformFloat(0.2, 0.9);
  s.awning = rng.chance(0.6) ? rng.uniformFloat(0.8, 1.7) : 0.0F;
  s.balconies = rng.chance(0.5) ? rng.uniformFloat(0.1, 0.8) : 0.0F;
  s.signs = rng.uniformFloat(0.2, 0.8);
  s.wall = rng.chance(0.5)   ? Material::plaster
           : rng.chance(0.5) ? Material::brick
                             : Material::concrete;
  return s;
}

void addShopHouse(Mesh& mesh, const ShopHouseStyle& s, const Eigen::Affine3f& transform, Rng& rng)
{
  Mesh local;
  addGroundFloor(local, s, rng);
  Mesh upper;
  addUpperFloors(upper, s, rng);
  const float top = s.ground_floor + s.floor_height * static_cast<float>(s.floors - 1);
  const float front = -s.projection;
  // Parapet
  addBox(upper, V(0.5F * s.width, 0.02F, top + 0.3F), V(s.width, 0.25F, 0.6F), s.wall);
  Eigen::Affine3f t = Eigen::Affine3f::Identity();
  t.translate(V(0, front, 0));
  local.append(upper, t);
  for (const float x : {0.0F, s.width})
  {
    addWall(local, {x, s.arcade}, {x, s.depth}, kBase, s.ground_floor, s.wall);
    addWall(local, {x, front}, {x, s.depth}, s.ground_floor, top, s.wall);
  }
  addWall(local, {0, s.depth}, {s.width, s.depth}, kBase, top, s.wall);
  local.addQuad(V(0, front, top), V(s.width, front, top), V(s.width, s.depth, top),
                V(0, s.depth, top), Material::roof);
  for (const float x : {0.15F, s.width - 0.15F})
  {
    addTube(local, V(x, -0.08F + front, s.ground_floor), V(x, -0.08F + front, top), 0.05F, 0.05F, 6,
            Material::steel);
  }
  mesh.append(local, transform);
}

void addAlley(Mesh& mesh, float width, float length, const Eigen::Affine3f& transform, Rng& rng)
{
  Mesh local;
  for (const float side : {-1.0F, 1.0F})
  {
    const float wall = side < 0 ? 0.0F : width;
    float y = 0, inset = 0;
    while (y < length)
    {
      const float next = std::min(length, y + rng.uniformFloat(3, 8)), top = rng.uniformFloat(3, 9);
      const float inset_next = rng.chance(0.5) ? rng.uniformFloat(0, 0.12) * width : 0.0F;
      const float x = wall - side * inset;
      addWall(local, {x, y}, {x, next}, kBase, top, Material::plaster);
      addWall(local, {x, next}, {wall - side * inset_next, next}, kBase, top, Material::plaster);
      if (rng.chance(0.5))  // a pipe
      {
        addTube(local, V(x - side * 0.1F, y + 0.5F, 0), V(x - side * 0.1F, y + 0.5F, top), 0.05F,
                0.05F, 6, Material::steel);
      }
      if (rng.chance(0.5))  // an air conditioner
      {
        addBox(local, V(x - side * 0.2F, 0.5F * (y + next), rng.uniformFloat(2.3, 3.5)),
               V(0.4F, 0.8F, 0.6F), Material::furniture);
      }
      if (rng.chance(0.6))  // boxes at the wall
      {
        const float tall = rng.uniformFloat(0.4, 1.6), deep = rng.uniformFloat(0.2, 0.25 * width);
        const float middle = rng.uniformFloat(y, next), wide = rng.uniformFloat(0.4, 1.5);
        addBox(local, V(x - side * 0.5F * deep, middle, 0.5F * tall), V(deep, wide, tall),
               Material::furniture);
      }
      if (rng.chance(0.25))  // a canopy
      {
        addBox(local, V(x - side * 0.4F, 0.5F * (y + next), 2.6F), V(0.8F, 1.6F, 0.06F),
               Material::roof);
      }
      inset = inset_next;
      y = next;
    }
  }
  addWall(local, {0, length}, {width, length}, kBase, rng.uniformFloat(2.2, 6), Material::plaster);
  mesh.append(local, transform);
}

void addGateWall(Mesh& mesh,
                 float width,
                 float height,
                 float gate,
                 float gate_width,
                 const Eigen::Affine3f& transform)
{
  Mesh local;
  const auto wall = [&](float x0, float x1)
  {
    addBox(local, V(0.5F * (x0 + x1), 0.12F, 0.5F * (height + kBase)),
           V(x1 - x0, 0.24F, height - kBase), Material::concrete);
  };
  wall(0, gate);
  wall(gate + gate_width, width);
  for (const float x : {gate - 0.1F, gate + gate_width + 0.1F})
  {
    addBox(local, V(x, 0.15F, 0.5F * height + 0.1F), V(0.45F, 0.45F, height + 0.6F),
           Material::concrete);
  }
  mesh.append(local, transform);
}
}  // namespace dyslam::sim
