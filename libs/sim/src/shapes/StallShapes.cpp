// SPDX-License-Identifier: BSD-3-Clause
// What stands on the pavements of a busy street: stalls, umbrellas and goods.
#include "Shapes.h"

namespace dyslam::sim
{
namespace
{
using V = Eigen::Vector3f;

/** Boxes of goods on a horizontal board. \param low, high corners of the board */
void addGoods(Mesh& mesh, Rng& rng, const V& low, const V& high)
{
  float x = low.x();
  while (x < high.x() - 0.2F)
  {
    const float width = rng.uniformFloat(0.2, 0.55), depth = rng.uniformFloat(0.25, 0.9),
                height = rng.uniformFloat(0.08, 0.5);
    const float middle = 0.5F * (low.y() + high.y());
    addBox(mesh, V(x + 0.5F * width, middle, low.z() + 0.5F * height),
           V(0.92F * width, depth * (high.y() - low.y()), height), Material::furniture);
    x += width + (rng.chance(0.3) ? 0.25F : 0.0F);
  }
}
}  // namespace

Mesh makeStall(Rng& rng, float length, float depth)
{
  Mesh mesh;
  const float half = 0.5F * length, back = 0.5F * depth;
  const float table = rng.uniformFloat(0.7, 0.95);
  addBox(mesh, V(0, 0, table), V(length - 0.15F, 0.85F * depth, 0.05F), Material::furniture);
  for (const float x : {-half + 0.12F, half - 0.12F})
  {
    addBox(mesh, V(x, 0, 0.5F * table), V(0.05F, 0.7F * depth, table), Material::furniture);
  }
  addGoods(mesh, rng, V(-half + 0.1F, -0.4F * depth, table + 0.03F),
           V(half - 0.1F, 0.4F * depth, table + 0.03F));
  if (rng.chance(0.5))
  {
    addGoods(mesh, rng, V(-half + 0.15F, -0.3F * depth, 0), V(half - 0.2F, 0.3F * depth, 0));
  }
  const float front_height = rng.uniformFloat(2.05, 2.3),
              back_height = front_height + rng.uniformFloat(0, 0.35);
  for (const float x : {-half, half})
  {
    addTube(mesh, V(x, -back, -0.1F), V(x, -back, front_height), 0.025F, 0.025F, 6,
            Material::steel);
    addTube(mesh, V(x, back, -0.1F), V(x, back, back_height), 0.025F, 0.025F, 6, Material::steel);
  }
  const V a(-half - 0.15F, -back - 0.2F, front_height - 0.05F),
      b(half + 0.15F, -back - 0.2F, front_height - 0.05F),
      c(half + 0.15F, back + 0.1F, back_height + 0.03F),
      d(-half - 0.15F, back + 0.1F, back_height + 0.03F);
  mesh.addQuad(a, b, c, d, Material::furniture);
  const V hem(0, 0, -0.2F);
  mesh.addQuad(a, b, b + hem, a + hem, Material::furniture);
  if (rng.chance(0.4))  // a cloth behind the stall
  {
    mesh.addQuad(V(-half, back, 0.3F), V(half, back, 0.3F), V(half, back, back_height),
                 V(-half, back, back_height), Material::furniture);
  }
  return mesh;
}

Mesh makeUmbrella(Rng& rng, float radius)
{
  Mesh mesh;
  const float height = rng.uniformFloat(2.3, 2.7);
  addTube(mesh, V(0, 0, -0.1F), V(0, 0, height), 0.025F, 0.025F, 6, Material::steel);
  addTube(mesh, V(0, 0, height), V(0, 0, height - 0.45F), 0.03F, radius, 8, Material::furniture);
  addTube(mesh, V(0, 0, 0), V(0, 0, 0.12F), 0.25F, 0.22F, 8, Material::furniture, true);
  const float table = rng.uniformFloat(0.5, 0.8);
  addTube(mesh, V(0.45F, 0, table - 0.05F), V(0.45F, 0, table), 0.38F, 0.38F, 8,
          Material::furniture, true);
  addTube(mesh, V(0.45F, 0, 0), V(0.45F, 0, table), 0.03F, 0.03F, 6, Material::furniture);
  for (const float side : {-1.0F, 1.0F})
  {
    addBox(mesh, V(0.45F, 0.6F * side, 0.22F), V(0.32F, 0.3F, 0.44F), Material::furniture);
  }
  return mesh;
}

Mesh makeGoodsPile(Rng& rng, float length, float depth)
{
  Mesh mesh;
  float x = -0.5F * length;
  while (x < 0.5F * length - 0.25F)
  {
    const float width = rng.uniformFloat(0.3, 0.7);
    float z = 0;
    const int layers = 1 + rng.below(4);
    for (int k = 0; k < layers; ++k)
    {
      const float height = rng.uniformFloat(0.15, 0.45), deep = depth * rng.uniformFloat(0.5, 1);
      addBox(mesh, V(x + 0.5F * width, 0.5F * (depth - deep), z + 0.5F * height),
             V(width * 0.95F, deep, height), Material::furniture);
      z += height;
    }
    x += width + (rng.chance(0.2) ? 0.4F : 0.0F);
  }
  return mesh;
}

Mesh makeClothesRack(Rng& rng, float length)
{
  Mesh mesh;
  const float half = 0.5F * length, height = rng.uniformFloat(1.4, 1.7);
  for (const float x : {-half, half})
  {
    addTube(mesh, V(x, 0, 0), V(x, 0, height), 0.02F, 0.02F, 6, Material::steel);
  }
  addTube(mesh, V(-half, 0, height), V(half, 0, height), 0.02F, 0.02F, 6, Material::steel);
  for (float x = -half + 0.1F; x < half - 0.05F; x += rng.uniformFloat(0.06, 0.2))
  {
    const float garment = rng.uniformFloat(0.6, 1.1);  // its length [m]
    addBox(mesh, V(x, 0, height - 0.5F * garment - 0.03F),
           V(0.04F, rng.uniformFloat(0.35, 0.5), garment), Material::furniture);
  }
  return mesh;
}
}  // namespace dyslam::sim
