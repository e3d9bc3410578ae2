// SPDX-License-Identifier: BSD-3-Clause
#include "Building.h"

#include <cmath>

namespace dyslam::sim
{
namespace
{
using V = Eigen::Vector3f;
}  // namespace

void addOpening(Mesh& mesh,
                const Rectangle& part,
                const Rectangle& opening,
                float recess,
                Material wall,
                Material pane)
{
  const auto [x0, x1, z0, z1] = part;
  const auto [wx0, wx1, wz0, wz1] = opening;
  const auto quad = [&](float ax, float az, float bx, float bz)
  { mesh.addQuad(V(ax, 0, az), V(bx, 0, az), V(bx, 0, bz), V(ax, 0, bz), wall); };
  quad(x0, z0, wx0, z1);
  quad(wx1, z0, x1, z1);
  quad(wx0, z0, wx1, wz0);
  quad(wx0, wz1, wx1, z1);
  const V a(wx0, 0, wz0), b(wx1, 0, wz0), c(wx1, 0, wz1), d(wx0, 0, wz1), in(0, recess, 0);
  mesh.addQuad(a, b, b + in, a + in, wall);
  mesh.addQuad(b, c, c + in, b + in, wall);
  mesh.addQuad(c, d, d + in, c + in, wall);
  mesh.addQuad(d, a, a + in, d + in, wall);
  mesh.addQuad(a + in, b + in, c + in, d + in, pane);
  // Cross bar of the window
  const float mid = 0.5F * (wx0 + wx1);
  if (pane == Material::window)
  {
    mesh.addQuad(V(mid - 0.04F, recess - 0.03F, wz0), V(mid + 0.04F, recess - 0.03F, wz0),
                 V(mid + 0.04F, recess - 0.03F, wz1), V(mid - 0.04F, recess - 0.03F, wz1), wall);
  }
}

void addBalcony(Mesh& mesh, float x, float z, float width, bool panel, Material wall)
{
  const float out = 1.15F;
  addBox(mesh, V(x, -0.5F * out, z), V(width, out, 0.16F), wall);
  if (panel)
  {
    addBox(mesh, V(x, -out + 0.03F, z + 0.55F), V(width, 0.05F, 0.95F), wall);
    for (const float side : {-0.5F, 0.5F})
    {
      addBox(mesh, V(x + side * width, -0.5F * out, z + 0.55F), V(0.05F, out, 0.95F), wall);
    }
    return;
  }
  addBox(mesh, V(x, -out + 0.03F, z + 1.05F), V(width, 0.05F, 0.05F), Material::concrete);
  for (float bx = -0.5F * width; bx <= 0.5F * width + 0.01F; bx += 0.18F)
  {
    addBox(mesh, V(x + bx, -out + 0.03F, z + 0.55F), V(0.02F, 0.02F, 1.0F), Material::concrete);
  }
}

namespace
{
/** Pilasters, downpipes, awnings, a step, and boxes at the foot of the wall. \param door bay with
 * the door */
void addFacadeDetails(Mesh& mesh, const BuildingStyle& s, float width, int bays, int door, Rng& rng)
{
  const float bay = width / static_cast<float>(bays);
  const float top = s.floor_height * static_cast<float>(s.floors);
  const bool pilasters = rng.chance(0.35);
  for (int b = 0; b <= bays && pilasters; ++b)
  {
    addBox(mesh, V(bay * static_cast<float>(b), -0.06F, 0.5F * top - 0.5F),
           V(0.35F, 0.14F, top + 1.0F), s.wall);
  }
  for (const float x : {0.25F, width - 0.25F})
  {
    addTube(mesh, V(x, -0.1F, -0.5F), V(x, -0.1F, top), 0.06F, 0.06F, 6, Material::steel);
  }
  for (int b = 0; b < bays; ++b)
  {
    const float mid = bay * (static_cast<float>(b) + 0.5F);
    if (s.shop && rng.chance(0.4))
    {
      mesh.addQuad(V(mid - 0.5F * bay, 0, 2.9F), V(mid + 0.5F * bay, 0, 2.9F),
                   V(mid + 0.5F * bay, -1.3F, 2.4F), V(mid - 0.5F * bay, -1.3F, 2.4F),
                   Material::roof);
    }
    if (rng.chance(0.15))
    {
      const float h = rng.chance(0.5) ? 0.5F : 1.1F;
      addBox(mesh, V(mid + 0.4F, -0.25F, 0.5F * h), V(0.7F, 0.45F, h), Material::furniture);
    }
  }
  addBox(mesh, V(bay * (static_cast<float>(door) + 0.5F), -0.25F, 0.0F), V(1.6F, 0.6F, 0.3F),
         Material::concrete);
}

/** A facade facing -y. Without `detail`: few windows, no balconies. */
void addFacade(Mesh& mesh, const BuildingStyle& s, float width, bool detail, Rng& rng)
{
  const int bays = std::max(1, static_cast<int>(std::lround(width / s.bay)));
  const float bay = width / static_cast<float>(bays);
  const float window = std::min(s.window_width, 0.8F * bay);
  const int door = detail ? rng.below(bays) : -1;
  const bool panel = rng.chance(0.5);
  // Balconies are arranged in columns.
  std::vector<bool> balcony_column(static_cast<std::size_t>(bays));
  for (auto&& c : balcony_column)
  {
    c = detail && rng.chance(static_cast<double>(s.balconies));
  }
  const float base = -1.5F;  // walls begin below the ground, for slopes [m]
  for (int f = 0; f < s.floors; ++f)
  {
    for (int b = 0; b < bays; ++b)
    {
      const float x0 = bay * static_cast<float>(b), x1 = x0 + bay, mid = 0.5F * (x0 + x1);
      const float floor = s.floor_height * static_cast<float>(f);
      const float z0 = f == 0 ? base : floor, z1 = floor + s.floor_height;
      const float sill = floor + 0.9F;
      const Rectangle part{x0, x1, z0, z1};
      if (f == 0 && b == door)
      {
        addOpening(mesh, part, {mid - 0.6F, mid + 0.6F, 0.1F, 2.3F}, 0.35F, s.wall,
                   Material::furniture);
      }
      else if (f == 0 && s.shop && detail)
      {
        addOpening(mesh, part, {x0 + 0.2F, x1 - 0.2F, 0.45F, 2.6F}, 0.3F, s.wall, Material::window);
      }
      else if (!detail && b % 3 != 1)
      {
        mesh.addQuad(V(x0, 0, z0), V(x1, 0, z0), V(x1, 0, z1), V(x0, 0, z1), s.wall);
      }
      else
      {
        const bool open = f > 0 && balcony_column[static_cast<std::size_t>(b)];
        const Rectangle pane{mid - 0.5F * window, mid + 0.5F * window, open ? floor + 0.15F : sill,
                             std::min(floor + 0.9F + s.window_height, z1 - 0.2F)};
        addOpening(mesh, part, pane, s.recess, s.wall, Material::window);
        if (open)
        {
          addBalcony(mesh, mid, floor + 0.02F, std::min(bay - 0.1F, 2.6F), panel, s.wall);
        }
        else if (detail)
        {
          addBox(mesh, V(mid, -0.05F, sill - 0.04F), V(window + 0.2F, 0.12F, 0.06F), s.wall);
        }
      }
    }
  }
  const float top = s.floor_height * static_cast<float>(s.floors);
  if (detail)
  {
    addFacadeDetails(mesh, s, width, bays, door, rng);
  }
  addBox(mesh, V(0.5F * width, -0.08F, top + 0.1F), V(width + 0.3F, 0.3F, 0.25F), s.wall);
}

void addRoof(Mesh& mesh, const BuildingStyle& s)
{
  const float top = s.floor_height * static_cast<float>(s.floors);
  const float w = s.width, d = s.depth;
  if (!s.gable)
  {
    mesh.addQuad(V(0, 0, top), V(w, 0, top), V(w, d, top), V(0, d, top), Material::roof);
    return;
  }
  const float ridge = top + 0.42F * d, over = 0.4F;
  const float eaves = top - 0.42F * over * 2;
  mesh.addQuad(V(-over, -over, eaves), V(w + over, -over, eaves), V(w + over, 0.5F * d, ridge),
               V(-over, 0.5F * d, ridge), Material::roof);
  mesh.addQuad(V(-over, d + over, eaves), V(w + over, d + over, eaves),
               V(w + over, 0.5F * d, ridge), V(-over, 0.5F * d, ridge), Material::roof);
  for (const float x : {0.0F, w})
  {
    mesh.addQuad(V(x, 0, top), V(x, d, top), V(x, 0.5F * d, ridge), V(x, 0.5F * d, ridge), s.wall);
  }
}
}  // namespace

BuildingStyle drawTownHouse(Rng& rng)
{
  BuildingStyle s;
  const auto in = [&](double a, double b) { return static_cast<float>(rng.uniform(a, b)); };
  s.width = in(10, 24);
  s.depth = in(9, 14);
  s.floors = 2 + rng.below(5);
  s.floor_height = in(2.7, 3.4);
  s.bay = in(2.2, 3.8);
  s.window_width = in(0.9, 1.8);
  s.window_height = in(1.2, 1.8);
  s.recess = in(0.08, 0.3);
  s.balconies = rng.chance(0.5) ? in(0.1, 0.6) : 0.0F;
  s.shop = rng.chance(0.35);
  s.gable = rng.chance(0.5);
  s.wall = rng.chance(0.5)   ? Material::plaster
           : rng.chance(0.6) ? Material::brick
                             : Material::concrete;
  return s;
}

BuildingStyle drawHouse(Rng& rng)
{
  BuildingStyle s = drawTownHouse(rng);
  s.width = static_cast<float>(rng.uniform(8, 13));
  s.depth = static_cast<float>(rng.uniform(8, 11));
  s.floors = 1 + rng.below(2);
  s.shop = false;
  s.gable = rng.chance(0.85);
  s.balconies = rng.chance(0.3) ? 0.2F : 0.0F;
  return s;
}

BuildingStyle drawHall(Rng& rng)
{
  BuildingStyle s = drawTownHouse(rng);
  s.width = static_cast<float>(rng.uniform(28, 60));
  s.depth = static_cast<float>(rng.uniform(14, 24));
  s.floors = 2 + rng.below(5);
  s.floor_height = static_cast<float>(rng.uniform(3.2, 4.2));
  s.bay = static_cast<float>(rng.uniform(3.0, 6.0));
  s.window_width = static_cast<float>(rng.uniform(1.5, 4.0));
  s.window_height = static_cast<float>(rng.uniform(1.4, 2.4));
  s.gable = false;
  s.balconies = 0;
  return s;
}

void addBuilding(Mesh& mesh, const BuildingStyle& style, const Eigen::Affine3f& transform, Rng& rng)
{
  Mesh local;
  const auto wall = [&](float x, float y, float yaw, float width, bool detail)
  {
    Mesh facade;
    addFacade(facade, style, width, detail, rng);
    Eigen::Affine3f t = Eigen::Affine3f::Identity();
    t.translate(V(x, y, 0));
    t.rotate(Eigen::AngleAxisf(yaw, V::UnitZ()));
    local.append(facade, t);
  };
  constexpr float kHalfTurn = 3.14159265F;
  const bool all_round = style.floors <= 2;
  wall(0, 0, 0, style.width, true);
  wall(style.width, 0, 0.5F * kHalfTurn, style.depth, all_round);
  wall(style.width, style.depth, kHalfTurn, style.width, all_round);
  wall(0, style.depth, -0.5F * kHalfTurn, style.depth, all_round);
  addRoof(local, style);
  mesh.append(local, transform);
}
}  // namespace dyslam::sim
