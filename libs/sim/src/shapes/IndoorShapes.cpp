// SPDX-License-Identifier: BSD-3-Clause
// What stands in public buildings, and what people carry and push there.
#include "Shapes.h"

namespace dyslam::sim
{
namespace
{
using V = Eigen::Vector3f;

/** Boxes of goods side by side on a board. \param low corner of the board [m] \param room free
 * height above the board [m] */
void addRowOfGoods(Mesh& mesh, Rng& rng, const V& low, float length, float depth, float room)
{
  float x = 0;
  while (x < length - 0.12F)
  {
    const float width = rng.uniformFloat(0.1, 0.5), deep = depth * rng.uniformFloat(0.5, 0.95),
                height = room * rng.uniformFloat(0.3, 0.9);
    if (x + width < length && rng.chance(0.85))
    {
      addBox(mesh, low + V(x + 0.5F * width, 0.5F * depth, 0.5F * height),
             V(0.94F * width, deep, height), Material::furniture);
    }
    x += width;
  }
}
}  // namespace

Mesh makeShelf(Rng& rng, float length, float depth, float height)
{
  Mesh mesh;
  const int boards = std::max(2, static_cast<int>(height / rng.uniformFloat(0.4, 0.6)));
  const float pitch = height / static_cast<float>(boards);
  for (const float x : {-0.5F * length, 0.5F * length})
  {
    addBox(mesh, V(x, 0, 0.5F * height), V(0.04F, depth, height), Material::furniture);
  }
  for (int i = 0; i < boards; ++i)
  {
    const float z = 0.1F + pitch * static_cast<float>(i);
    addBox(mesh, V(0, 0, z), V(length, depth, 0.03F), Material::furniture);
    addRowOfGoods(mesh, rng, V(-0.5F * length + 0.04F, -0.5F * depth, z + 0.015F), length - 0.08F,
                  depth, pitch - 0.05F);
  }
  return mesh;
}

Mesh makePalletRack(Rng& rng, float length, float height)
{
  Mesh mesh;
  const float depth = 1.0F;
  const int bays = std::max(1, static_cast<int>(length / 2.7F));
  const float bay = length / static_cast<float>(bays);
  for (int i = 0; i <= bays; ++i)
  {
    for (const float y : {-0.45F, 0.45F})
    {
      addBox(mesh, V(-0.5F * length + bay * static_cast<float>(i), y, 0.5F * height),
             V(0.09F, 0.08F, height), Material::steel);
    }
  }
  for (float z = 0.05F; z < height - 0.6F; z += 1.15F)
  {
    for (const float y : {-0.45F, 0.45F})
    {
      addBox(mesh, V(0, y, z + 0.06F), V(length, 0.05F, 0.12F), Material::steel);
    }
    addRowOfGoods(mesh, rng, V(-0.5F * length, -0.5F * depth, z + 0.13F), length, depth, 0.9F);
    addRowOfGoods(mesh, rng, V(-0.5F * length, -0.5F * depth, z + 0.13F), length, depth, 0.5F);
  }
  return mesh;
}

Mesh makeVendingMachine()
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.95F), V(0.95F, 0.8F, 1.8F), Material::furniture);
  addBox(mesh, V(0.3F, -0.42F, 1.2F), V(0.2F, 0.05F, 0.4F), Material::furniture);
  addBox(mesh, V(-0.1F, -0.41F, 0.35F), V(0.5F, 0.04F, 0.2F), Material::steel);
  return mesh;
}

Mesh makePotPlant(Rng& rng, float height)
{
  Mesh mesh;
  const float pot = rng.uniformFloat(0.35, 0.55);
  addTube(mesh, V(0, 0, 0), V(0, 0, pot), 0.2F, 0.28F, 10, Material::furniture, true);
  addTube(mesh, V(0, 0, pot), V(0, 0, pot + 0.4F * height), 0.03F, 0.02F, 6, Material::bark);
  Eigen::Affine3f above = Eigen::Affine3f::Identity();
  above.translate(V(0, 0, pot + 0.25F * height));
  mesh.append(makeBush(rng, 0.35F, 0.7F * height), above);
  return mesh;
}

Mesh makeAdvertisingBoard()
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 1.1F), V(1.25F, 0.14F, 1.8F), Material::furniture);
  addBox(mesh, V(0, 0, 0.1F), V(0.9F, 0.3F, 0.2F), Material::steel);
  return mesh;
}

Mesh makeCounter(float length)
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.5F), V(length, 0.6F, 1.0F), Material::furniture);
  addBox(mesh, V(0, -0.05F, 1.03F), V(length + 0.1F, 0.75F, 0.06F), Material::furniture);
  for (float x = -0.5F * length + 0.6F; x < 0.5F * length - 0.3F; x += 1.4F)
  {
    addBox(mesh, V(x, 0.05F, 1.25F), V(0.4F, 0.12F, 0.35F), Material::furniture);
  }
  return mesh;
}

Mesh makeKiosk(float length, float depth)
{
  Mesh mesh;
  const float x = 0.5F * length, y = 0.5F * depth;
  for (const float side : {-1.0F, 1.0F})
  {
    addBox(mesh, V(0, side * (y - 0.25F), 0.55F), V(length, 0.5F, 1.1F), Material::furniture);
    addBox(mesh, V(side * (x - 0.25F), 0, 0.55F), V(0.5F, depth, 1.1F), Material::furniture);
    for (const float end : {-1.0F, 1.0F})
    {
      addTube(mesh, V(side * (x - 0.1F), end * (y - 0.1F), 1.1F),
              V(side * (x - 0.1F), end * (y - 0.1F), 2.4F), 0.04F, 0.04F, 6, Material::steel);
    }
  }
  addBox(mesh, V(0, 0, 2.55F), V(length, depth, 0.35F), Material::furniture);
  return mesh;
}

Mesh makeDesk()
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.73F), V(1.6F, 0.8F, 0.03F), Material::furniture);
  for (const float x : {-0.75F, 0.75F})
  {
    addBox(mesh, V(x, 0, 0.36F), V(0.05F, 0.7F, 0.72F), Material::steel);
  }
  addBox(mesh, V(0.5F, 0, 0.35F), V(0.4F, 0.6F, 0.55F), Material::furniture);
  addBox(mesh, V(0, 0.2F, 1.0F), V(0.55F, 0.06F, 0.35F), Material::furniture);
  addBox(mesh, V(0, -0.65F, 0.46F), V(0.48F, 0.48F, 0.06F), Material::furniture);
  addBox(mesh, V(0, -0.88F, 0.78F), V(0.45F, 0.06F, 0.5F), Material::furniture);
  addTube(mesh, V(0, -0.65F, 0), V(0, -0.65F, 0.44F), 0.03F, 0.03F, 6, Material::steel);
  return mesh;
}

Mesh makeCupboard(float length, float height)
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.5F * height), V(length, 0.45F, height), Material::furniture);
  for (float x = -0.5F * length + 0.5F; x < 0.5F * length - 0.1F; x += 0.5F)
  {
    addBox(mesh, V(x - 0.06F, -0.24F, 0.55F * height), V(0.02F, 0.03F, 0.2F), Material::steel);
  }
  return mesh;
}

Mesh makeSuitcase()
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.22F), V(0.15F, 0.26F, 0.38F), Material::cloth);
  for (const float y : {-0.08F, 0.08F})
  {
    addTube(mesh, V(0.02F, y, 0.4F), V(0.14F, y, 0.56F), 0.008F, 0.008F, 5, Material::steel);
  }
  return mesh;
}

Mesh makeShoppingTrolley()
{
  Mesh mesh;
  const float x = 0.28F, y = 0.16F;
  for (const float side : {-1.0F, 1.0F})
  {
    for (float z = 0.26F; z < 0.56F; z += 0.05F)  // bars of the basket
    {
      addTube(mesh, V(-x, side * y, z), V(x, side * y, z), 0.005F, 0.005F, 4, Material::steel);
      addTube(mesh, V(side * x, -y, z), V(side * x, y, z), 0.005F, 0.005F, 4, Material::steel);
    }
    addTube(mesh, V(-x, side * y, 0.04F), V(x, side * y, 0.1F), 0.01F, 0.01F, 5, Material::steel);
    addTube(mesh, V(-x, side * y, 0.04F), V(-x, side * y, 0.6F), 0.01F, 0.01F, 5, Material::steel);
    for (const float end : {-1.0F, 1.0F})
    {
      addBox(mesh, V(end * x, side * y, 0.035F), V(0.07F, 0.025F, 0.07F), Material::rubber);
    }
  }
  addBox(mesh, V(0, 0, 0.26F), V(2 * x, 2 * y, 0.01F), Material::steel);
  addBox(mesh, V(0.04F, 0, 0.36F), V(1.4F * x, 1.5F * y, 0.18F), Material::furniture);
  return mesh;
}

Mesh makeCleaningMachine()
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.5F), V(1.2F, 0.75F, 0.75F), Material::paint);
  addBox(mesh, V(-0.25F, 0, 1.0F), V(0.6F, 0.7F, 0.35F), Material::paint);
  addBox(mesh, V(0.45F, 0, 0.07F), V(0.35F, 0.9F, 0.12F), Material::rubber);
  addTube(mesh, V(0.3F, 0, 0.85F), V(0.3F, 0, 1.3F), 0.03F, 0.03F, 6, Material::steel, true);
  for (const float y : {-0.33F, 0.33F})
  {
    addBox(mesh, V(-0.35F, y, 0.12F), V(0.25F, 0.08F, 0.24F), Material::rubber);
  }
  return mesh;
}
}  // namespace dyslam::sim
