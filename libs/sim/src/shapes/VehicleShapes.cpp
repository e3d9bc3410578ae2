// SPDX-License-Identifier: BSD-3-Clause
#include "Shapes.h"

namespace dyslam::sim
{
namespace
{
using V = Eigen::Vector3f;

/** Rounded cross-section of a vehicle body at x. */
std::vector<V> shellSection(float x, float half_width, float bottom, float top)
{
  const float w = half_width;
  const float h = top - bottom;
  return {{x, -0.90F * w, bottom},
          {x, 0.90F * w, bottom},
          {x, w, bottom + 0.25F * h},
          {x, w, bottom + 0.65F * h},
          {x, 0.93F * w, bottom + 0.95F * h},
          {x, 0.85F * w, top},
          {x, -0.85F * w, top},
          {x, -0.93F * w, bottom + 0.95F * h},
          {x, -w, bottom + 0.65F * h},
          {x, -w, bottom + 0.25F * h}};
}

void addWheel(Mesh& mesh, float x, float y, float radius, float width)
{
  const float half = 0.5F * width;
  addTube(mesh, V(x, y - half, radius), V(x, y + half, radius), radius, radius, 12,
          Material::rubber, true);
}

void addWheels(Mesh& mesh, std::initializer_list<float> stations, float half_width, float radius)
{
  for (const float x : stations)
  {
    for (const float side : {-1.0F, 1.0F})
    {
      addWheel(mesh, x, side * (half_width - 0.13F), radius, 0.22F);
    }
  }
}

/** Windows between belt line and roof. */
void addGreenhouse(Mesh& mesh, const CarStyle& s, float belt_z)
{
  const float front = 0.5F * s.length - s.hood;
  const float rear = -0.5F * s.length + s.trunk;
  const float roof_front = front - s.windscreen;
  const float roof_rear = rear + s.rear_window;
  const float w0 = 0.46F * s.width;
  const float w1 = 0.37F * s.width;
  const float z1 = s.height;
  const float z0 = belt_z - 0.03F;
  const std::array<V, 4> low{V(rear, -w0, z0), V(front, -w0, z0), V(front, w0, z0),
                             V(rear, w0, z0)};
  const std::array<V, 4> high{V(roof_rear, -w1, z1), V(roof_front, -w1, z1), V(roof_front, w1, z1),
                              V(roof_rear, w1, z1)};
  mesh.addQuad(high[0], high[1], high[2], high[3], Material::paint);
  mesh.addQuad(low[1], low[2], high[2], high[1], Material::car_glass);
  mesh.addQuad(low[3], low[0], high[0], high[3],
               s.closed_rear ? Material::paint : Material::car_glass);
  // Sides: painted pillars at both ends and in the middle, glass between them.
  for (const int side : {0, 1})
  {
    const V l0 = side != 0 ? low[3] : low[0], l1 = side != 0 ? low[2] : low[1];
    const V h0 = side != 0 ? high[3] : high[0], h1 = side != 0 ? high[2] : high[1];
    const std::array<float, 8> cuts{0, 0.10F, 0.32F, 0.36F, 0.62F, 0.66F, 0.95F, 1};
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
    {
      const bool glass = i % 2 == 1 && !(s.closed_rear && cuts[i] < 0.6F);
      const auto between = [](const V& a, const V& b, float f) { return V(a + f * (b - a)); };
      const V b0 = between(l0, l1, cuts[i]), b1 = between(l0, l1, cuts[i + 1]);
      const V t0 = between(h0, h1, cuts[i]), t1 = between(h0, h1, cuts[i + 1]);
      const V m0 = between(b0, t0, 0.85F), m1 = between(b1, t1, 0.85F);
      mesh.addQuad(b0, b1, m1, m0, glass ? Material::car_glass : Material::paint);
      mesh.addQuad(m0, m1, t1, t0, Material::paint);
    }
  }
}
}  // namespace

CarStyle drawCarStyle(Rng& rng)
{
  CarStyle s;
  const auto in = [&](double a, double b) { return static_cast<float>(rng.uniform(a, b)); };
  switch (rng.below(4))
  {
    case 0:  // saloon
      s = {in(4.3, 4.9), in(1.75, 1.88), in(1.40, 1.50), in(1.0, 1.25), in(0.55, 0.85),
           0.63F,        in(0.7, 0.9),   in(0.5, 0.8),   false};
      break;
    case 1:  // hatchback
      s = {in(3.6, 4.3), in(1.65, 1.8), in(1.45, 1.56), in(0.75, 1.0), 0.05F,
           0.62F,        in(0.7, 0.95), in(0.25, 0.5),  false};
      break;
    case 2:  // estate
      s = {in(4.4, 4.9), in(1.75, 1.85), in(1.45, 1.55), in(0.95, 1.2), 0.05F,
           0.62F,        in(0.7, 0.9),   in(0.2, 0.45),  false};
      break;
    default:  // tall
      s = {in(4.2, 4.9), in(1.82, 1.98), in(1.60, 1.82), in(0.9, 1.1), 0.05F,
           0.63F,        in(0.6, 0.8),   in(0.2, 0.4),   false};
  }
  return s;
}

CarStyle drawVanStyle(Rng& rng)
{
  const auto in = [&](double a, double b) { return static_cast<float>(rng.uniform(a, b)); };
  return {in(4.9, 6.2), in(1.9, 2.08), in(1.95, 2.6), in(0.5, 0.8),   0.02F,
          0.55F,        in(0.5, 0.8),  0.06F,         rng.chance(0.6)};
}

Mesh makeCar(const CarStyle& s)
{
  Mesh mesh;
  const float half_length = 0.5F * s.length;
  const float half_width = 0.5F * s.width;
  const float belt = s.belt * s.height;
  const float hood_front = 0.80F * belt;
  const float clearance = 0.2F;
  const float trunk_top = s.trunk > 0.2F ? 0.97F * belt : belt;
  addLoft(mesh,
          {shellSection(-half_length, 0.86F * half_width, 0.35F, 0.8F * trunk_top),
           shellSection(-half_length + 0.12F, 0.96F * half_width, 0.25F, 0.96F * trunk_top),
           shellSection(-half_length + 0.5F, half_width, clearance, trunk_top),
           shellSection(half_length - s.hood, half_width, clearance, belt),
           shellSection(half_length - 0.4F * s.hood, 0.98F * half_width, clearance, 0.93F * belt),
           shellSection(half_length - 0.15F, 0.92F * half_width, 0.22F, hood_front),
           shellSection(half_length, 0.78F * half_width, 0.32F, 0.75F * hood_front)},
          Material::paint);
  addGreenhouse(mesh, s, belt);
  const float radius = s.height > 1.9F ? 0.35F : 0.31F;
  addWheels(mesh, {0.31F * s.length, -0.29F * s.length}, half_width, radius);
  for (const float side : {-1.0F, 1.0F})
  {
    addBox(mesh, V(half_length - s.hood - 0.25F, side * (half_width - 0.01F), belt + 0.07F),
           V(0.12F, 0.18F, 0.13F), Material::paint);
    addBox(mesh, V(half_length - 0.06F, side * 0.62F * half_width, 0.62F * belt),
           V(0.1F, 0.3F, 0.12F), Material::lamp);
    addBox(mesh, V(-half_length + 0.06F, side * 0.7F * half_width, 0.75F * belt),
           V(0.1F, 0.2F, 0.18F), Material::lamp);
  }
  addBox(mesh, V(-half_length + 0.02F, 0, 0.6F), V(0.06F, 0.5F, 0.12F), Material::licence_plate);
  addBox(mesh, V(half_length - 0.01F, 0, 0.42F), V(0.06F, 0.5F, 0.12F), Material::licence_plate);
  return mesh;
}

Mesh makeTruck(float length, float width, float height, bool trailer)
{
  Mesh mesh;
  const float half = 0.5F * length;
  const float cab = trailer ? 2.3F : 1.9F;
  const float gap = trailer ? 0.8F : 0.3F;
  const float cab_height = std::min(height, trailer ? 3.4F : 2.9F);
  const auto section = [&](float x, float top)
  { return shellSection(x, 0.5F * width, 0.45F, top); };
  addLoft(mesh,
          {section(half - cab, cab_height), section(half - 0.6F, cab_height),
           section(half - 0.12F, 0.55F * cab_height), section(half, 0.5F * cab_height)},
          Material::paint);
  mesh.addQuad(V(half - 0.13F, -0.45F * width, 0.58F * cab_height),
               V(half - 0.13F, 0.45F * width, 0.58F * cab_height),
               V(half - 0.58F, 0.45F * width, 0.97F * cab_height),
               V(half - 0.58F, -0.45F * width, 0.97F * cab_height), Material::car_glass);
  const float cargo = length - cab - gap;
  addBox(mesh, V(-half + 0.5F * cargo, 0, 0.5F * (height + 1.05F)), V(cargo, width, height - 1.05F),
         Material::paint);
  addBox(mesh, V(-0.3F, 0, 0.85F), V(length - 1.0F, 0.9F, 0.3F), Material::steel);
  addBox(mesh, V(-half + 0.1F, 0, 0.55F), V(0.1F, 0.9F * width, 0.14F), Material::guard_rail);
  addBox(mesh, V(-half + 0.03F, 0.3F, 0.75F), V(0.04F, 0.5F, 0.12F), Material::licence_plate);
  if (trailer)
  {
    addWheels(mesh, {half - 1.3F, half - 4.6F, -half + 1.5F, -half + 2.8F, -half + 4.1F},
              0.5F * width, 0.5F);
  }
  else
  {
    addWheels(mesh, {half - 1.2F, -half + 1.6F}, 0.5F * width, 0.48F);
  }
  return mesh;
}

Mesh makeBus(float length, float width, float height)
{
  Mesh mesh;
  const float half = 0.5F * length;
  const float w = 0.5F * width;
  const auto section = [&](float x, float scale, float top)
  { return shellSection(x, scale * w, 0.32F, top); };
  addLoft(mesh,
          {section(-half, 0.95F, 0.97F * height), section(-half + 0.15F, 1, height),
           section(half - 0.2F, 1, height), section(half, 0.94F, 0.95F * height)},
          Material::paint);
  // A band of windows a little outside the shell, with pillars between them.
  const float pitch = 1.5F;
  for (float x = -half + 0.5F; x + pitch < half - 0.3F; x += pitch)
  {
    for (const float side : {-1.003F, 1.003F})
    {
      mesh.addQuad(V(x + 0.1F, side * w, 1.25F), V(x + pitch, side * w, 1.25F),
                   V(x + pitch, side * w, 0.32F + 0.65F * (height - 0.32F)),
                   V(x + 0.1F, side * w, 0.32F + 0.65F * (height - 0.32F)), Material::car_glass);
    }
  }
  mesh.addQuad(V(half + 0.01F, -0.85F * w, 1.1F), V(half + 0.01F, 0.85F * w, 1.1F),
               V(half + 0.01F, 0.85F * w, 0.85F * height),
               V(half + 0.01F, -0.85F * w, 0.85F * height), Material::car_glass);
  addWheels(mesh, {half - 2.7F, -half + 3.2F}, w, 0.48F);
  return mesh;
}

Mesh makeScooter(bool rider)
{
  Mesh mesh;
  addTube(mesh, V(0.65F, -0.06F, 0.28F), V(0.65F, 0.06F, 0.28F), 0.28F, 0.28F, 12, Material::rubber,
          true);
  addTube(mesh, V(-0.65F, -0.08F, 0.28F), V(-0.65F, 0.08F, 0.28F), 0.28F, 0.28F, 12,
          Material::rubber, true);
  addBox(mesh, V(-0.35F, 0, 0.62F), V(0.9F, 0.32F, 0.4F), Material::paint);
  addBox(mesh, V(0.05F, 0, 0.38F), V(0.7F, 0.3F, 0.15F), Material::paint);
  addTube(mesh, V(0.62F, 0, 0.4F), V(0.42F, 0, 1.05F), 0.09F, 0.09F, 6, Material::paint, true);
  addTube(mesh, V(0.42F, -0.35F, 1.05F), V(0.42F, 0.35F, 1.05F), 0.025F, 0.025F, 5, Material::steel,
          true);
  if (!rider)
  {
    return mesh;
  }
  addEllipsoid(mesh, V(-0.18F, 0, 1.12F), V(0.16F, 0.23F, 0.35F), 10, Material::cloth);
  addEllipsoid(mesh, V(-0.1F, 0, 1.58F), V(0.14F, 0.13F, 0.15F), 10, Material::paint);
  for (const float side : {-1.0F, 1.0F})
  {
    addTube(mesh, V(-0.13F, side * 0.22F, 1.35F), V(0.38F, side * 0.28F, 1.07F), 0.06F, 0.05F, 6,
            Material::cloth, true);
    addTube(mesh, V(-0.2F, side * 0.14F, 0.86F), V(0.22F, side * 0.2F, 0.78F), 0.09F, 0.07F, 6,
            Material::cloth, true);
    addTube(mesh, V(0.22F, side * 0.2F, 0.78F), V(0.15F, side * 0.18F, 0.42F), 0.06F, 0.05F, 6,
            Material::cloth, true);
  }
  return mesh;
}
}  // namespace dyslam::sim
