// SPDX-License-Identifier: BSD-3-Clause
#include "Shapes.h"

namespace dyslam::sim
{
namespace
{
using V = Eigen::Vector3f;

void addPole(Mesh& mesh, float height, float radius)
{
  addTube(mesh, V(0, 0, -0.2F), V(0, 0, height), radius, 0.85F * radius, 8, Material::steel, true);
}
}  // namespace

Mesh makeLampPost(float height, float arm)
{
  Mesh mesh;
  addPole(mesh, height, 0.085F);
  addTube(mesh, V(0, 0, -0.2F), V(0, 0, 1.0F), 0.12F, 0.11F, 8, Material::steel, true);
  addTube(mesh, V(0, 0, height - 0.1F), V(0, arm, height + 0.25F), 0.05F, 0.04F, 6,
          Material::steel);
  addBox(mesh, V(0, arm, height + 0.25F), V(0.25F, 0.7F, 0.14F), Material::steel);
  return mesh;
}

Mesh makeSign(int kind)
{
  Mesh mesh;
  const float height = kind == 3 ? 3.6F : 2.5F;
  addPole(mesh, height, 0.035F);
  const float size = kind == 3 ? 0.9F : 0.6F;
  std::vector<V> rim;
  const int corners = kind == 0 ? 3 : kind == 1 ? 8 : 4;
  const float turn = kind == 0 ? 1.5707963F : 0.7853982F;
  for (int i = 0; i < corners; ++i)
  {
    const float a = turn + 6.2831853F * static_cast<float>(i) / static_cast<float>(corners);
    rim.emplace_back(0.05F, 0.6F * size * std::cos(a) * (kind == 3 ? 1.6F : 1.0F),
                     height - 0.5F * size + 0.6F * size * std::sin(a));
  }
  std::vector<V> back = rim;
  for (auto& p : back)
  {
    p.x() = 0.04F;
  }
  addLoft(mesh, {back, rim}, Material::sign_face);
  return mesh;
}

Mesh makeTrafficLight()
{
  Mesh mesh;
  addPole(mesh, 3.2F, 0.07F);
  addBox(mesh, V(0.15F, 0, 2.75F), V(0.25F, 0.3F, 0.9F), Material::sign_face);
  return mesh;
}

Mesh makeBollard()
{
  Mesh mesh;
  addTube(mesh, V(0, 0, -0.1F), V(0, 0, 0.95F), 0.06F, 0.06F, 8, Material::steel, true);
  return mesh;
}

Mesh makeBin()
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.5F), V(0.55F, 0.6F, 1.0F), Material::furniture);
  addBox(mesh, V(0, 0, 1.05F), V(0.6F, 0.62F, 0.08F), Material::furniture);
  return mesh;
}

Mesh makeCabinet()
{
  Mesh mesh;
  addBox(mesh, V(0, 0, 0.6F), V(1.2F, 0.4F, 1.3F), Material::furniture);
  return mesh;
}

Mesh makeBench()
{
  Mesh mesh;
  for (int i = 0; i < 4; ++i)
  {
    addBox(mesh, V(0, -0.2F + 0.12F * static_cast<float>(i), 0.45F), V(1.7F, 0.09F, 0.04F),
           Material::furniture);
  }
  for (int i = 0; i < 3; ++i)
  {
    addBox(mesh, V(0, 0.26F, 0.6F + 0.13F * static_cast<float>(i)), V(1.7F, 0.04F, 0.09F),
           Material::furniture);
  }
  for (const float x : {-0.7F, 0.7F})
  {
    addBox(mesh, V(x, 0, 0.22F), V(0.06F, 0.45F, 0.46F), Material::steel);
  }
  return mesh;
}

Mesh makeFence(int kind, float length, float height)
{
  Mesh mesh;
  const auto posts = [&](float pitch, float size)
  {
    for (float x = 0; x <= length + 0.01F; x += pitch)
    {
      addBox(mesh, V(x, 0, 0.5F * height - 0.05F), V(size, size, height + 0.1F),
             Material::wood_fence);
    }
  };
  switch (kind)
  {
    case 0:  // boards with gaps
      posts(2.0F, 0.1F);
      for (float x = 0.06F; x < length; x += 0.16F)
      {
        addBox(mesh, V(x, 0.04F, 0.5F * height), V(0.12F, 0.02F, 0.95F * height),
               Material::wood_fence);
      }
      break;
    case 1:  // upright bars
      posts(2.0F, 0.08F);
      for (float x = 0.12F; x < length; x += 0.13F)
      {
        addBox(mesh, V(x, 0, 0.5F * height), V(0.02F, 0.02F, 0.9F * height), Material::wood_fence);
      }
      addBox(mesh, V(0.5F * length, 0, 0.92F * height), V(length, 0.03F, 0.04F),
             Material::wood_fence);
      addBox(mesh, V(0.5F * length, 0, 0.12F), V(length, 0.03F, 0.04F), Material::wood_fence);
      break;
    case 2:  // rails
      posts(2.0F, 0.12F);
      for (const float z : {0.35F, 0.65F, 0.95F})
      {
        addBox(mesh, V(0.5F * length, 0, z * height), V(length, 0.04F, 0.11F),
               Material::wood_fence);
      }
      break;
    default:  // wall
      addBox(mesh, V(0.5F * length, 0, 0.5F * height - 0.1F), V(length, 0.24F, height + 0.2F),
             Material::wood_fence);
      addBox(mesh, V(0.5F * length, 0, height), V(length, 0.32F, 0.08F), Material::wood_fence);
  }
  return mesh;
}

Mesh makeBusStop()
{
  Mesh mesh;
  addBox(mesh, V(0, 0.6F, 2.4F), V(3.6F, 1.5F, 0.1F), Material::furniture);
  for (const float x : {-1.75F, 1.75F})
  {
    addTube(mesh, V(x, 1.25F, 0), V(x, 1.25F, 2.4F), 0.05F, 0.05F, 6, Material::steel);
    mesh.addQuad(V(x, 0.1F, 0.2F), V(x, 1.2F, 0.2F), V(x, 1.2F, 2.2F), V(x, 0.1F, 2.2F),
                 Material::window);
  }
  mesh.addQuad(V(-1.75F, 1.28F, 0.2F), V(1.75F, 1.28F, 0.2F), V(1.75F, 1.28F, 2.2F),
               V(-1.75F, 1.28F, 2.2F), Material::window);
  addBox(mesh, V(0, 0.95F, 0.45F), V(2.4F, 0.35F, 0.06F), Material::furniture);
  return mesh;
}
}  // namespace dyslam::sim
