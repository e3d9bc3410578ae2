// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "Material.h"

namespace dyslam::sim
{
/** Quadrilateral mesh (triangles repeat their last corner) with one material per quad. */
struct Mesh
{
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 4>> quads;
  std::vector<Material> materials;  //!< one per quad

  [[nodiscard]] bool empty() const { return quads.empty(); }
  [[nodiscard]] Eigen::AlignedBox3f bounds() const;

  void addQuad(const Eigen::Vector3f& a,
               const Eigen::Vector3f& b,
               const Eigen::Vector3f& c,
               const Eigen::Vector3f& d,
               Material material);
  void append(const Mesh& other, const Eigen::Affine3f& transform);
};

/** Axis-aligned box. */
void addBox(Mesh& mesh,
            const Eigen::Vector3f& centre,
            const Eigen::Vector3f& size,
            Material material);

/** Tube from a to b with `sides` faces, radius from ra to rb; closed ends if `caps`. */
void addTube(Mesh& mesh,
             const Eigen::Vector3f& a,
             const Eigen::Vector3f& b,
             float ra,
             float rb,
             int sides,
             Material material,
             bool caps = false);

/** Ellipsoid of the given half axes. */
void addEllipsoid(Mesh& mesh,
                  const Eigen::Vector3f& centre,
                  const Eigen::Vector3f& half_axes,
                  int sides,
                  Material material);

/** Closed surface through cross-sections with equal numbers of corners. */
void addLoft(Mesh& mesh,
             const std::vector<std::vector<Eigen::Vector3f>>& sections,
             Material material,
             bool caps = true);
}  // namespace dyslam::sim
