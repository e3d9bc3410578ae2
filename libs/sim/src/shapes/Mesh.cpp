// SPDX-License-Identifier: BSD-3-Clause
#include "Mesh.h"

#include <cmath>

namespace dyslam::sim
{
namespace
{
constexpr float kFullTurn = 6.2831853F;

std::vector<Eigen::Vector3f> circle(const Eigen::Vector3f& centre,
                                    const Eigen::Vector3f& u,
                                    const Eigen::Vector3f& v,
                                    int sides)
{
  std::vector<Eigen::Vector3f> points;
  points.reserve(static_cast<std::size_t>(sides));
  for (int i = 0; i < sides; ++i)
  {
    const float angle = kFullTurn * static_cast<float>(i) / static_cast<float>(sides);
    points.push_back(centre + std::cos(angle) * u + std::sin(angle) * v);
  }
  return points;
}
}  // namespace

Eigen::AlignedBox3f Mesh::bounds() const
{
  Eigen::AlignedBox3f box;
  for (const auto& v : vertices)
  {
    box.extend(v);
  }
  return box;
}

void Mesh::addQuad(const Eigen::Vector3f& a,
                   const Eigen::Vector3f& b,
                   const Eigen::Vector3f& c,
                   const Eigen::Vector3f& d,
                   Material material)
{
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), {a, b, c, d});
  quads.push_back({first, first + 1, first + 2, first + 3});
  materials.push_back(material);
}

void Mesh::append(const Mesh& other, const Eigen::Affine3f& transform)
{
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (const auto& v : other.vertices)
  {
    vertices.push_back(transform * v);
  }
  for (const auto& q : other.quads)
  {
    quads.push_back({first + q[0], first + q[1], first + q[2], first + q[3]});
  }
  materials.insert(materials.end(), other.materials.begin(), other.materials.end());
}

void addLoft(Mesh& mesh,
             const std::vector<std::vector<Eigen::Vector3f>>& sections,
             Material material,
             bool caps)
{
  if (sections.empty())
  {
    return;
  }
  const std::size_t corners = sections.front().size();
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& section : sections)
  {
    mesh.vertices.insert(mesh.vertices.end(), section.begin(), section.end());
  }
  const auto vertex = [&](std::size_t section, std::size_t corner)
  { return first + static_cast<std::uint32_t>(section * corners + corner % corners); };
  const auto face = [&](std::array<std::uint32_t, 4> quad)
  {
    mesh.quads.push_back(quad);
    mesh.materials.push_back(material);
  };
  for (std::size_t s = 0; s + 1 < sections.size(); ++s)
  {
    for (std::size_t c = 0; c < corners; ++c)
    {
      face({vertex(s, c), vertex(s, c + 1), vertex(s + 1, c + 1), vertex(s + 1, c)});
    }
  }
  if (caps)
  {
    for (const std::size_t s : {std::size_t{0}, sections.size() - 1})
    {
      for (std::size_t c = 1; c + 1 < corners; c += 2)
      {
        face({vertex(s, 0), vertex(s, c), vertex(s, c + 1),
              vertex(s, std::min(c + 2, corners - 1))});
      }
    }
  }
}

void addBox(Mesh& mesh,
            const Eigen::Vector3f& centre,
            const Eigen::Vector3f& size,
            Material material)
{
  const Eigen::Vector3f h = 0.5F * size;
  const auto section = [&](float x)
  {
    return std::vector<Eigen::Vector3f>{
        centre + Eigen::Vector3f(x, -h.y(), -h.z()), centre + Eigen::Vector3f(x, h.y(), -h.z()),
        centre + Eigen::Vector3f(x, h.y(), h.z()), centre + Eigen::Vector3f(x, -h.y(), h.z())};
  };
  addLoft(mesh, {section(-h.x()), section(h.x())}, material);
}

void addTube(Mesh& mesh,
             const Eigen::Vector3f& a,
             const Eigen::Vector3f& b,
             float ra,
             float rb,
             int sides,
             Material material,
             bool caps)
{
  const Eigen::Vector3f axis = (b - a).normalized();
  const Eigen::Vector3f u = axis.unitOrthogonal();
  const Eigen::Vector3f v = axis.cross(u);
  addLoft(mesh, {circle(a, ra * u, ra * v, sides), circle(b, rb * u, rb * v, sides)}, material,
          caps);
}

void addEllipsoid(Mesh& mesh,
                  const Eigen::Vector3f& centre,
                  const Eigen::Vector3f& half_axes,
                  int sides,
                  Material material)
{
  const int rows = std::max(3, sides / 2);
  std::vector<std::vector<Eigen::Vector3f>> sections;
  for (int r = 0; r <= rows; ++r)
  {
    const float latitude =
        0.5F * kFullTurn * (static_cast<float>(r) / static_cast<float>(rows) - 0.5F);
    const float radius = std::max(0.02F, std::cos(latitude));
    sections.push_back(circle(centre + Eigen::Vector3f(0, 0, half_axes.z() * std::sin(latitude)),
                              Eigen::Vector3f(radius * half_axes.x(), 0, 0),
                              Eigen::Vector3f(0, radius * half_axes.y(), 0), sides));
  }
  addLoft(mesh, sections, material, false);
}
}  // namespace dyslam::sim
