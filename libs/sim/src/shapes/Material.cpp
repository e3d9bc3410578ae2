// SPDX-License-Identifier: BSD-3-Clause
#include "Material.h"

namespace dyslam::sim
{
const std::array<MaterialProperties, static_cast<std::size_t>(Material::count)>& materialTable()
{
  // semantic, reflectivity, spread, roughness, relief, loss, gloss
  static constexpr std::array<MaterialProperties, static_cast<std::size_t>(Material::count)> table{{
      {40, 0.24F, 0.06F, 0.002F, 5.0F, 0.0F, 0.15F},  // asphalt
      {40, 0.65F, 0.15F, 0.002F, 5.0F, 0.0F, 0.15F},  // marking
      {48, 0.36F, 0.08F, 0.003F, 3.0F, 0.0F, 0.1F},   // paving
      {72, 0.35F, 0.15F, 0.030F, 6.0F, 0.01F, 0.0F},  // lawn
      {72, 0.22F, 0.08F, 0.040F, 3.0F, 0.01F, 0.0F},  // soil
      {50, 0.45F, 0.10F, 0.016F, 2.0F, 0.0F, 0.1F},   // plaster
      {50, 0.30F, 0.10F, 0.020F, 4.0F, 0.0F, 0.1F},   // brick
      {50, 0.35F, 0.08F, 0.014F, 2.0F, 0.0F, 0.1F},   // concrete
      {50, 0.12F, 0.05F, 0.010F, 0.8F, 0.25F, 0.8F},  // window
      {50, 0.25F, 0.08F, 0.015F, 3.0F, 0.0F, 0.1F},   // roof
      {0, 0.30F, 0.05F, 0.012F, 2.0F, 0.03F, 0.55F},  // paint
      {0, 0.10F, 0.04F, 0.004F, 2.0F, 0.62F, 0.7F},   // car_glass
      {0, 0.06F, 0.02F, 0.008F, 8.0F, 0.05F, 0.2F},   // rubber
      {0, 1.00F, 0.02F, 0.002F, 2.0F, 0.0F, 0.0F},    // licence_plate
      {0, 0.60F, 0.30F, 0.006F, 6.0F, 0.1F, 0.3F},    // lamp
      {0, 0.30F, 0.05F, 0.015F, 7.0F, 0.01F, 0.0F},   // cloth
      {0, 0.45F, 0.05F, 0.008F, 9.0F, 0.0F, 0.0F},    // skin
      {0, 0.30F, 0.20F, 0.006F, 8.0F, 0.10F, 0.3F},   // bicycle_frame
      {70, 0.35F, 0.15F, 0.090F, 4.0F, 0.06F, 0.0F},  // leaf
      {71, 0.25F, 0.08F, 0.015F, 7.0F, 0.0F, 0.0F},   // bark
      {70, 0.35F, 0.15F, 0.100F, 6.0F, 0.04F, 0.0F},  // hedge
      {80, 0.40F, 0.15F, 0.003F, 3.0F, 0.0F, 0.2F},   // steel
      {81, 0.95F, 0.05F, 0.002F, 1.0F, 0.0F, 0.0F},   // sign_face
      {51, 0.30F, 0.10F, 0.016F, 5.0F, 0.0F, 0.1F},   // wood_fence
      {51, 0.50F, 0.15F, 0.008F, 2.0F, 0.0F, 0.4F},   // guard_rail
      {99, 0.30F, 0.15F, 0.010F, 4.0F, 0.0F, 0.1F},   // furniture
      {49, 0.30F, 0.06F, 0.001F, 3.0F, 0.0F, 0.35F},  // floor
      {50, 0.50F, 0.08F, 0.004F, 1.5F, 0.0F, 0.1F},   // inner_wall
  }};
  return table;
}
}  // namespace dyslam::sim
