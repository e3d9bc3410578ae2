// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/sim/Simulator.h>

#include <deque>
#include <memory>
#include <vector>

#include "FloorPlan.h"
#include "Ground.h"
#include "Random.h"
#include "Roads.h"
#include "sensor/RayScene.h"
#include "shapes/Body.h"

namespace dyslam::sim
{
/** Number of label instances of bodies that may move, from the highest downwards. */
constexpr int kMovingInstances = 30000;
/** Number of label instances of parked vehicles, from 1. */
constexpr int kParkedInstances = 65535 - kMovingInstances;

/** A queue in front of a counter. */
struct QueueSpot
{
  Eigen::Vector2d head;       //!< where the person stands that is served [m]
  Eigen::Vector2d direction;  //!< unit vector from the head to the end
  int places = 0;
};

/** Static geometry with semantics, the shapes of all bodies, and the networks they move on. */
class World
{
 public:
  World(WorldKind world_kind, std::uint64_t world_seed)
      : kind(world_kind), seed(world_seed), scene(device.handle())
  {
  }

  // Building blocks for the generators
  /** Registers a shape for instancing. */
  int addShape(Mesh mesh);
  /** Places a static instance of a shape. \param transform shape to world \param instance in the
   * labels, 0 for none */
  void place(int shape,
             const Eigen::Affine3f& transform,
             std::uint16_t semantic = 0,
             std::uint16_t instance = 0,
             float reflectivity = -1);
  /** Places a static instance of a shape upright on the ground. \param yaw in the world frame [rad]
   */
  void placeOnGround(int shape, const Eigen::Vector2d& world_position, double yaw, float scale = 1);
  /** Places a parked vehicle or bicycle. \param model index in `bodies` */
  void park(int model, const Eigen::Vector2d& world_position, double yaw, Rng& rng);
  [[nodiscard]] std::uint16_t nextInstance()
  {
    return static_cast<std::uint16_t>(1 + instances_++ % kParkedInstances);
  }
  /** Builds the scene; the world must not be changed afterwards. */
  void finish();

  WorldKind kind;
  std::uint64_t seed;
  std::unique_ptr<Ground> ground;
  LaneNetwork roads;  //!< streets of urban and downtown, service road of campus worlds
  WalkNetwork walks;  //!< walkways of urban, downtown, campus, field and indoor worlds
  std::vector<Path> bicycle_loops;  //!< closed, at the edge of the carriageway
  FloorPlan floor_plan;             //!< of indoor worlds
  std::vector<QueueSpot> queues;    //!< where people queue in indoor worlds
  Path ego_path;                    //!< closed path of the ego in campus, field and indoor worlds
  Path highway;                     //!< closed centre line of highway and tunnel worlds
  int highway_lanes = 3;            //!< number of lanes each way
  double highway_lane_width = 3.6;  //!< width of a lane [m]
  double highway_median = 1.6;      //!< distance from the centre line to the first lane [m]
  double loop_length = 0;           //!< length of the ego's loop [m]

  std::vector<BodyModel> bodies;
  std::vector<int> cars, vans, trucks, buses, riders, people, cyclists,
      parked_bicycles;                    //!< indices in `bodies`
  std::vector<int> travellers, machines;  //!< people with luggage and cleaning machines, indoors

  RayDevice device;
  std::deque<Mesh> meshes;  //!< static meshes, world frame
  std::deque<Mesh> shape_meshes;
  std::vector<RayScene> shapes;
  RayScene scene;  //!< all static geometry

 private:
  struct Placement
  {
    int shape;
    Eigen::Affine3f transform;
    SceneItem item;
  };
  std::vector<Placement> placements_;
  int instances_ = 0;
};

/** Adds the model of a rigid body. \return its index in World::bodies */
int addRigid(World& world, Mesh mesh, ObjectClass object_class, double wheelbase);
/** Adds body models of all kinds, each in several variants. */
void addBodies(World& world, Rng& rng);

/** Shares of the kinds of vehicles in traffic; the others are cars. */
struct VehicleMix
{
  double heavy = 0.06;   //!< trucks and buses
  double vans = 0.14;    //!< vans
  double riders = 0.04;  //!< motorcyclists
};
/** Draws a vehicle. \return index in World::bodies */
[[nodiscard]] int drawVehicle(const World& world, Rng& rng, const VehicleMix& mix);
/** Draws a reflectivity of paint or clothes from a realistic distribution. */
[[nodiscard]] float drawPaint(Rng& rng);
/** SemanticKITTI classes of a body at rest (first) and in motion (second). */
[[nodiscard]] std::pair<std::uint16_t, std::uint16_t> semanticClasses(ObjectClass object_class);

void buildUrban(World& world, const SimulatorOptions& options);
void buildDowntown(World& world, const SimulatorOptions& options);
void buildCampus(World& world, const SimulatorOptions& options);
void buildHighway(World& world, const SimulatorOptions& options);  //!< highway or tunnel
void buildField(World& world, const SimulatorOptions& options);
/** \throws UserError if the loop is too short or too long, or the ego is a car. */
void buildIndoor(World& world, const SimulatorOptions& options);
}  // namespace dyslam::sim
