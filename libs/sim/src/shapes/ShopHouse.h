// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Mesh.h"
#include "Random.h"

namespace dyslam::sim
{
/** A house of a dense city, with shops on the ground floor. */
struct ShopHouseStyle
{
  float width = 6, depth = 14;  //!< extent along and away from the street [m]
  int floors = 3;               //!< with the ground floor
  float ground_floor = 3.6F, floor_height = 3.1F;
  float arcade = 0;        //!< depth of a covered walk behind pillars in front of the shops [m]
  float projection = 0;    //!< by how much the upper floors project over the pavement [m]
  float unit = 4;          //!< approximate width of a shop or entrance [m]
  float open = 0.6F;       //!< share of open shops
  float awning = 1.2F;     //!< depth of the awnings; 0 for none [m]
  float balconies = 0.3F;  //!< share of the upper windows with a balcony
  float signs = 0.5F;      //!< share of the shops with a sign board perpendicular to the front
  Material wall = Material::plaster;
};

[[nodiscard]] ShopHouseStyle drawShopHouse(Rng& rng);

/** Adds a house whose frame has its origin at the front's left corner on the ground, x along the
 * front and y into the house. Shops are open spaces with side walls, a back wall, shelves and
 * counters. \param transform house to mesh frame */
void addShopHouse(Mesh& mesh,
                  const ShopHouseStyle& style,
                  const Eigen::Affine3f& transform,
                  Rng& rng);

/** Adds the uneven walls of an alley from y = 0 inwards, with pipes, air conditioners, canopies and
 * boxes, at 0 < x < width; its end is a wall. \param width, length [m] */
void addAlley(Mesh& mesh, float width, float length, const Eigen::Affine3f& transform, Rng& rng);

/** Adds a wall of a courtyard along x with an open gate. \param gate, gate_width begin and width of
 * the gate along x [m] */
void addGateWall(Mesh& mesh,
                 float width,
                 float height,
                 float gate,
                 float gate_width,
                 const Eigen::Affine3f& transform);
}  // namespace dyslam::sim
