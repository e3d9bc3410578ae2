// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Mesh.h"
#include "Random.h"

namespace dyslam::sim
{
struct BuildingStyle
{
  float width = 14, depth = 10;  //!< extent along and away from the street [m]
  int floors = 4;
  float floor_height = 3.0F;
  float bay = 3.0F;  //!< width of a bay with one window [m]
  float window_width = 1.3F, window_height = 1.5F;
  float recess = 0.18F;    //!< depth of the windows in the wall [m]
  float balconies = 0.2F;  //!< share of bays above the ground floor that have a balcony
  bool shop = false;       //!< large panes on the ground floor
  bool gable = false;      //!< a pitched roof
  Material wall = Material::plaster;
};

[[nodiscard]] BuildingStyle drawTownHouse(Rng& rng);
[[nodiscard]] BuildingStyle drawHouse(Rng& rng);
[[nodiscard]] BuildingStyle drawHall(Rng& rng);

/** Rectangle in the plane y = 0 [m]. */
struct Rectangle
{
  float x0, x1, z0, z1;
};

/** Adds a part of a wall around an opening, with the opening's reveals and pane. \param recess of
 * the pane in the wall [m] */
void addOpening(Mesh& mesh,
                const Rectangle& part,
                const Rectangle& opening,
                float recess,
                Material wall,
                Material pane);

/** Adds a balcony in front of the wall y = 0. \param x, z middle of its floor \param panel a closed
 * parapet instead of bars */
void addBalcony(Mesh& mesh, float x, float z, float width, bool panel, Material wall);

/** Adds a building whose frame has its origin at the front's left corner on the ground, x along the
 * front and y into the building. \param transform building to mesh frame */
void addBuilding(Mesh& mesh,
                 const BuildingStyle& style,
                 const Eigen::Affine3f& transform,
                 Rng& rng);
}  // namespace dyslam::sim
