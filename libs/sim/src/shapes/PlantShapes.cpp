// SPDX-License-Identifier: BSD-3-Clause
#include "Shapes.h"

namespace dyslam::sim
{
namespace
{
using V = Eigen::Vector3f;

float in(Rng& rng, double a, double b)
{
  return static_cast<float>(rng.uniform(a, b));
}

float in(Rng& rng, const SizeRange& range)
{
  return in(rng, range.low, range.high);
}

/** A clump of leaves: one small quad with random orientation. Beams pass between clumps. */
void addLeaves(Mesh& mesh, Rng& rng, const V& centre, float size, Material material)
{
  const float z = in(rng, -1, 1), y = in(rng, -1, 1), x = in(rng, -1, 1);
  V u(x, y, z);
  u = (u.norm() > 0.05F ? u : V(1, 0, 0)).normalized();
  const V w = u.unitOrthogonal();
  const float angle = in(rng, 0, 6.2831853);
  const V v = std::cos(angle) * w + std::sin(angle) * u.cross(w);
  mesh.addQuad(centre - size * u, centre - 0.6F * size * v, centre + size * u,
               centre + 0.6F * size * v, material);
}

/** Leaves in an ellipsoid, denser near its surface. */
void addCrown(
    Mesh& mesh, Rng& rng, const V& centre, const V& half, int clumps, float size, Material material)
{
  for (int i = 0; i < clumps; ++i)
  {
    const auto z = static_cast<float>(rng.gaussian());
    const auto y = static_cast<float>(rng.gaussian());
    const auto x = static_cast<float>(rng.gaussian());
    V d(x, y, z);
    d.normalize();
    const float radius = std::cbrt(in(rng, 0.15, 1.0)) *
                         (0.85F + 0.25F * latticeNoise(3 * d.x(), 3 * d.y(), 3 * d.z()));
    addLeaves(mesh, rng, centre + radius * d.cwiseProduct(half), size * in(rng, 0.6, 1.3),
              material);
  }
}
}  // namespace

Mesh makeTree(Rng& rng, float height, float crown_radius, float trunk_height)
{
  Mesh mesh;
  const float r = 0.018F * height + 0.06F;
  const float lean_y = in(rng, -0.05, 0.05), lean_x = in(rng, -0.05, 0.05);
  const V lean(lean_x, lean_y, 0);
  const V fork = V(0, 0, trunk_height) + trunk_height * lean;
  addTube(mesh, V(0, 0, -0.3F), V(0, 0, 0.25F), 1.5F * r, r, 8, Material::bark);
  addTube(mesh, V(0, 0, 0.25F), fork, r, 0.8F * r, 8, Material::bark);
  addTube(mesh, fork, V(fork.x(), fork.y(), 0.85F * height), 0.75F * r, 0.2F * r, 6,
          Material::bark);
  const int branches = 5 + rng.below(4);
  const float crown_half = 0.5F * (height - trunk_height) + 0.2F;
  const V centre(fork.x(), fork.y(), trunk_height + crown_half);
  for (int i = 0; i < branches; ++i)
  {
    const float a = in(rng, 0, 6.2831853);
    const V tip = centre + V(0.7F * crown_radius * std::cos(a), 0.7F * crown_radius * std::sin(a),
                             in(rng, -0.4, 0.4) * crown_half);
    addTube(mesh, fork + V(0, 0, in(rng, 0, 0.4) * crown_half), tip, 0.35F * r, 0.1F * r, 5,
            Material::bark);
    addCrown(mesh, rng, tip, V(0.55F, 0.55F, 0.45F) * crown_radius, 40, 0.22F, Material::leaf);
  }
  addCrown(mesh, rng, centre, V(crown_radius, crown_radius, crown_half),
           150 + static_cast<int>(60 * crown_radius), 0.24F, Material::leaf);
  return mesh;
}

Mesh makeConifer(Rng& rng, float height, float radius)
{
  Mesh mesh;
  addTube(mesh, V(0, 0, -0.3F), V(0, 0, height), 0.02F * height + 0.05F, 0.03F, 7, Material::bark);
  const int clumps = static_cast<int>(60 * height);
  for (int i = 0; i < clumps; ++i)
  {
    const float f = std::sqrt(in(rng, 0, 1));
    const float z = height * (1 - 0.92F * f);
    const float r = radius * f * in(rng, 0.3, 1.0);
    const float a = in(rng, 0, 6.2831853);
    addLeaves(mesh, rng, V(r * std::cos(a), r * std::sin(a), z), 0.2F, Material::leaf);
  }
  return mesh;
}

Mesh makeBush(Rng& rng, float radius, float height)
{
  Mesh mesh;
  addCrown(mesh, rng, V(0, 0, 0.5F * height), V(radius, radius, 0.55F * height),
           60 + static_cast<int>(120 * radius * height), 0.15F, Material::leaf);
  return mesh;
}

Mesh makeHedge(Rng& rng, float length, float width, float height)
{
  Mesh mesh;
  addBox(mesh, V(0.5F * length, 0, 0.42F * height), V(length, 0.6F * width, 0.84F * height),
         Material::hedge);
  const int clumps = static_cast<int>(45 * length * height);
  for (int i = 0; i < clumps; ++i)
  {
    const float side = rng.chance(0.5) ? 1.0F : -1.0F;
    const bool top = rng.chance(0.25);
    const float y = top ? in(rng, -0.5, 0.5) * width : side * in(rng, 0.3, 0.5) * width;
    const float z = top ? height * in(rng, 0.85, 1.0) : height * in(rng, 0, 1);
    addLeaves(mesh, rng, V(in(rng, 0, 1) * length, y, z), 0.1F, Material::hedge);
  }
  return mesh;
}

Mesh makeGrassTuft(Rng& rng, float radius, float height)
{
  Mesh mesh;
  for (int i = 0; i < 40; ++i)
  {
    const float a = in(rng, 0, 6.2831853);
    const float r = radius * std::sqrt(in(rng, 0, 1));
    const V foot(r * std::cos(a), r * std::sin(a), -0.05F);
    const float z = height * in(rng, 0.6, 1);
    const float y = in(rng, -0.15, 0.15), x = in(rng, -0.15, 0.15);
    const V tip = foot + V(x, y, z);
    const V side(0.03F * std::cos(3 * a), 0.03F * std::sin(3 * a), 0);
    mesh.addQuad(foot - side, foot + side, tip, tip, Material::leaf);
  }
  return mesh;
}

Mesh drawTree(Rng& rng,
              const SizeRange& height,
              const SizeRange& crown_radius,
              const SizeRange& trunk_height)
{
  const float trunk = in(rng, trunk_height), crown = in(rng, crown_radius);
  return makeTree(rng, in(rng, height), crown, trunk);
}

Mesh drawConifer(Rng& rng, const SizeRange& height, const SizeRange& radius)
{
  const float r = in(rng, radius);
  return makeConifer(rng, in(rng, height), r);
}

Mesh drawBush(Rng& rng, const SizeRange& radius, const SizeRange& height)
{
  const float h = in(rng, height);
  return makeBush(rng, in(rng, radius), h);
}
}  // namespace dyslam::sim
