// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace dyslam::sim
{
/** Surface material. The order is that of materialTable(). */
enum class Material : std::uint8_t
{
  asphalt,
  marking,
  paving,
  lawn,
  soil,
  plaster,
  brick,
  concrete,
  window,
  roof,
  paint,  // paint of vehicles; the instance has its reflectivity
  car_glass,
  rubber,
  licence_plate,
  lamp,
  cloth,  // the instance has its reflectivity
  skin,
  bicycle_frame,
  leaf,
  bark,
  hedge,
  steel,
  sign_face,
  wood_fence,
  guard_rail,
  furniture,
  floor,       // smooth floor of a building
  inner_wall,  // painted wall or ceiling of a room
  count
};

struct MaterialProperties
{
  std::uint16_t semantic;  //!< SemanticKITTI class; 0: class of the instance
  float reflectivity;      //!< diffuse, in [0, 1]
  float spread;            //!< variation of the reflectivity over the surface
  float roughness;         //!< amplitude of the relief [m]
  float relief_per_metre;  //!< spatial frequency of the relief [1/m]
  float loss;              //!< fraction of beams without a return at any range
  float gloss;             //!< additional loss at grazing incidence, in [0, 1]
};

[[nodiscard]] const std::array<MaterialProperties, static_cast<std::size_t>(Material::count)>&
materialTable();

[[nodiscard]] inline const MaterialProperties& properties(Material material)
{
  return materialTable()[static_cast<std::size_t>(material)];
}
}  // namespace dyslam::sim
