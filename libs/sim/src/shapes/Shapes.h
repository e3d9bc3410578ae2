// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Mesh.h"
#include "Random.h"

namespace dyslam::sim
{
// Vehicles: x forward, y left, z up, origin on the ground below the centre of the box.
struct CarStyle
{
  float length = 4.4F, width = 1.8F, height = 1.48F;
  float hood = 1.0F;         //!< length in front of the windscreen [m]
  float trunk = 0.6F;        //!< length behind the rear window [m]; 0 for hatchbacks
  float belt = 0.62F;        //!< height of the windows' lower edge, as a fraction of the height
  float windscreen = 0.8F;   //!< horizontal length of the windscreen [m]
  float rear_window = 0.5F;  //!< horizontal length of the rear window [m]
  bool closed_rear = false;  //!< a van without rear side windows
};
[[nodiscard]] Mesh makeCar(const CarStyle& style);
[[nodiscard]] CarStyle drawCarStyle(Rng& rng);
[[nodiscard]] CarStyle drawVanStyle(Rng& rng);
[[nodiscard]] Mesh makeTruck(float length, float width, float height, bool trailer);
[[nodiscard]] Mesh makeBus(float length, float width, float height);
[[nodiscard]] Mesh makeScooter(bool rider);

// Pedestrians of height 1 m, to be scaled. The torso's origin is between the feet; limbs hang from
// their joint at the origin.
[[nodiscard]] Mesh makeTorso(bool backpack, bool coat);
[[nodiscard]] Mesh makeArm();
[[nodiscard]] Mesh makeThigh();
[[nodiscard]] Mesh makeShank();
/** Bicycle and the rider's upper body in metres, origin on the ground below the centre. */
[[nodiscard]] Mesh makeBicycle(bool rider);

// Plants: origin at the foot.
[[nodiscard]] Mesh makeTree(Rng& rng, float height, float crown_radius, float trunk_height);
[[nodiscard]] Mesh makeConifer(Rng& rng, float height, float radius);
[[nodiscard]] Mesh makeBush(Rng& rng, float radius, float height);
[[nodiscard]] Mesh makeHedge(Rng& rng, float length, float width, float height);
[[nodiscard]] Mesh makeGrassTuft(Rng& rng, float radius, float height);
/** Bounds of a randomly drawn size [m]. */
struct SizeRange
{
  double low, high;
};
[[nodiscard]] Mesh drawTree(Rng& rng,
                            const SizeRange& height,
                            const SizeRange& crown_radius,
                            const SizeRange& trunk_height);
[[nodiscard]] Mesh drawConifer(Rng& rng, const SizeRange& height, const SizeRange& radius);
[[nodiscard]] Mesh drawBush(Rng& rng, const SizeRange& radius, const SizeRange& height);

// Street furniture: origin at the foot, x away from the carriageway's direction of travel.
[[nodiscard]] Mesh makeLampPost(float height, float arm);
[[nodiscard]] Mesh makeSign(int kind);
[[nodiscard]] Mesh makeTrafficLight();
[[nodiscard]] Mesh makeBollard();
[[nodiscard]] Mesh makeBin();
[[nodiscard]] Mesh makeCabinet();
[[nodiscard]] Mesh makeBench();
/** A fence along x from the origin. */
[[nodiscard]] Mesh makeFence(int kind, float length, float height);
[[nodiscard]] Mesh makeBusStop();

// What stands on the pavements of a busy street: origin at the foot of the middle, x along the
// street, y away from the carriageway.
/** A table with goods below a canopy on four posts. */
[[nodiscard]] Mesh makeStall(Rng& rng, float length, float depth);
/** An umbrella above a table and two stools. */
[[nodiscard]] Mesh makeUmbrella(Rng& rng, float radius);
/** Boxes in layers; flush at +y. */
[[nodiscard]] Mesh makeGoodsPile(Rng& rng, float length, float depth);
[[nodiscard]] Mesh makeClothesRack(Rng& rng, float length);

// What stands in public buildings: origin on the floor at the middle, x along the wall, y towards
// it.
/** Boards with goods between two sides. */
[[nodiscard]] Mesh makeShelf(Rng& rng, float length, float depth, float height);
/** A rack of a warehouse with goods, 1 m deep. */
[[nodiscard]] Mesh makePalletRack(Rng& rng, float length, float height);
[[nodiscard]] Mesh makeVendingMachine();
[[nodiscard]] Mesh makePotPlant(Rng& rng, float height);
[[nodiscard]] Mesh makeAdvertisingBoard();
[[nodiscard]] Mesh makeCounter(float length);
/** Four counters below a roof. */
[[nodiscard]] Mesh makeKiosk(float length, float depth);
/** A desk with a screen and a chair. */
[[nodiscard]] Mesh makeDesk();
[[nodiscard]] Mesh makeCupboard(float length, float height);

// What people take with them, to be scaled by their height; origin on the floor at the middle.
[[nodiscard]] Mesh makeSuitcase();
[[nodiscard]] Mesh makeShoppingTrolley();
/** A floor cleaning robot in metres, as the vehicles. */
[[nodiscard]] Mesh makeCleaningMachine();
}  // namespace dyslam::sim
