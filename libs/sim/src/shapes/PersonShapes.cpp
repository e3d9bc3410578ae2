// SPDX-License-Identifier: BSD-3-Clause
#include "Shapes.h"

namespace dyslam::sim
{
using V = Eigen::Vector3f;

// Proportions of an adult of height 1: hips at 0.52, shoulders at 0.81, knee 0.245 below the hip.
Mesh makeTorso(bool backpack, bool coat)
{
  Mesh mesh;
  const auto ring = [](float z, float x, float y)
  {
    std::vector<V> points;
    for (int i = 0; i < 10; ++i)
    {
      const float a = 6.2831853F * static_cast<float>(i) / 10.0F;
      points.emplace_back(x * std::cos(a), y * std::sin(a), z);
    }
    return points;
  };
  const float hem = coat ? 0.36F : 0.49F;
  addLoft(mesh,
          {ring(hem, coat ? 0.085F : 0.07F, coat ? 0.11F : 0.095F), ring(0.56F, 0.072F, 0.1F),
           ring(0.66F, 0.066F, 0.09F), ring(0.76F, 0.075F, 0.118F), ring(0.815F, 0.06F, 0.125F),
           ring(0.84F, 0.035F, 0.05F)},
          Material::cloth);
  addTube(mesh, V(0, 0, 0.83F), V(0, 0, 0.88F), 0.03F, 0.03F, 6, Material::skin);
  addEllipsoid(mesh, V(0.01F, 0, 0.935F), V(0.055F, 0.046F, 0.065F), 10, Material::skin);
  if (backpack)
  {
    addBox(mesh, V(-0.115F, 0, 0.7F), V(0.09F, 0.16F, 0.2F), Material::cloth);
  }
  return mesh;
}

Mesh makeArm()
{
  Mesh mesh;
  addTube(mesh, V(0, 0, 0.01F), V(-0.005F, 0, -0.17F), 0.032F, 0.027F, 6, Material::cloth, true);
  addTube(mesh, V(-0.005F, 0, -0.17F), V(0.035F, 0, -0.33F), 0.026F, 0.02F, 6, Material::cloth,
          true);
  addEllipsoid(mesh, V(0.045F, 0, -0.36F), V(0.02F, 0.015F, 0.04F), 6, Material::skin);
  return mesh;
}

Mesh makeThigh()
{
  Mesh mesh;
  addTube(mesh, V(0, 0, 0.02F), V(0, 0, -0.25F), 0.052F, 0.036F, 8, Material::cloth, true);
  return mesh;
}

Mesh makeShank()
{
  Mesh mesh;
  addTube(mesh, V(0, 0, 0.01F), V(0, 0, -0.24F), 0.036F, 0.024F, 8, Material::cloth, true);
  addBox(mesh, V(0.035F, 0, -0.25F), V(0.15F, 0.055F, 0.045F), Material::rubber);
  return mesh;
}

Mesh makeBicycle(bool rider)
{
  Mesh mesh;
  const auto wheel = [&](float x)
  {
    // A rim of short tubes, with spokes.
    for (int i = 0; i < 14; ++i)
    {
      const float a = 6.2831853F * static_cast<float>(i) / 14.0F;
      const float b = 6.2831853F * static_cast<float>(i + 1) / 14.0F;
      addTube(mesh, V(x + 0.33F * std::cos(a), 0, 0.35F + 0.33F * std::sin(a)),
              V(x + 0.33F * std::cos(b), 0, 0.35F + 0.33F * std::sin(b)), 0.022F, 0.022F, 4,
              Material::rubber);
      if (i % 2 == 0)
      {
        addTube(mesh, V(x, 0, 0.35F), V(x + 0.33F * std::cos(a), 0, 0.35F + 0.33F * std::sin(a)),
                0.004F, 0.004F, 3, Material::bicycle_frame);
      }
    }
  };
  wheel(0.52F);
  wheel(-0.52F);
  const V bottom(-0.05F, 0, 0.3F), seat(-0.2F, 0, 0.85F), head(0.36F, 0, 0.82F);
  const V front(0.52F, 0, 0.35F), back(-0.52F, 0, 0.35F);
  const auto bar = [&](const V& a, const V& b)
  { addTube(mesh, a, b, 0.018F, 0.018F, 5, Material::bicycle_frame, true); };
  bar(bottom, seat);
  bar(bottom, head);
  bar(V(-0.17F, 0, 0.75F), head);
  bar(head, front);
  bar(back, bottom);
  bar(back, V(-0.17F, 0, 0.75F));
  bar(head, V(0.4F, 0, 1.0F));
  bar(V(0.4F, -0.29F, 1.02F), V(0.4F, 0.29F, 1.02F));
  addBox(mesh, V(-0.22F, 0, 0.93F), V(0.26F, 0.15F, 0.06F), Material::rubber);
  if (rider)
  {
    // Torso leaning forward.
    addTube(mesh, V(-0.2F, 0, 0.95F), V(-0.08F, 0, 1.2F), 0.15F, 0.14F, 9, Material::cloth, true);
    addTube(mesh, V(-0.08F, 0, 1.2F), V(0.06F, 0, 1.45F), 0.14F, 0.17F, 9, Material::cloth, true);
    addEllipsoid(mesh, V(0.13F, 0, 1.66F), V(0.11F, 0.09F, 0.13F), 10, Material::skin);
    for (const float side : {-1.0F, 1.0F})
    {
      addTube(mesh, V(0.05F, side * 0.19F, 1.42F), V(0.2F, side * 0.26F, 1.2F), 0.05F, 0.045F, 6,
              Material::cloth, true);
      addTube(mesh, V(0.2F, side * 0.26F, 1.2F), V(0.4F, side * 0.25F, 1.05F), 0.042F, 0.035F, 6,
              Material::cloth, true);
    }
  }
  return mesh;
}
}  // namespace dyslam::sim
