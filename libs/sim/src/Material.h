// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace dyslam::sim
{
/** What a surface is made of. The order is that of materialTable(). */
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
  paint,  // of vehicles; its reflectivity is the instance's
  car_glass,
  rubber,
  licence_plate,
  lamp,
  cloth,  // its reflectivity is the instance's
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
  count
};

struct MaterialProperties
{
  std::uint16_t semantic;  //!< SemanticKITTI class; 0 where the instance says it
  float reflectivity;      //!< diffuse, in [0, 1]
  float spread;            //!< of the reflectivity over the surface
  float roughness;         //!< height of the relief [m]
  float relief_per_metre;  //!< bumps in a metre
  float loss;              //!< share of beams that give no return whatever the range
  float gloss;             //!< how much more is lost at grazing incidence, in [0, 1]
};

[[nodiscard]] const std::array<MaterialProperties, static_cast<std::size_t>(Material::count)>&
materialTable();

[[nodiscard]] inline const MaterialProperties& properties(Material material)
{
  return materialTable()[static_cast<std::size_t>(material)];
}
}  // namespace dyslam::sim
