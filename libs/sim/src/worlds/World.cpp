// SPDX-License-Identifier: BSD-3-Clause
#include "World.h"

#include <dyslam/base/Error.h>

#include "Random.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
int addRigid(World& world, Mesh mesh, ObjectClass object_class, double wheelbase)
{
  BodyModel model;
  const Eigen::AlignedBox3f box = mesh.bounds();
  model.object_class = object_class;
  model.size = box.sizes().cast<double>();
  model.centre_x = static_cast<double>(box.center().x());
  model.wheelbase = wheelbase;
  model.shapes = {world.addShape(std::move(mesh))};
  world.bodies.push_back(model);
  return static_cast<int>(world.bodies.size()) - 1;
}

namespace
{
void addPeople(World& world, Rng& rng)
{
  const int arm = world.addShape(makeArm());
  const int thigh = world.addShape(makeThigh());
  const int shank = world.addShape(makeShank());
  for (int i = 0; i < 9; ++i)
  {
    BodyModel model;
    model.object_class = ObjectClass::pedestrian;
    model.gait = BodyModel::Gait::walking;
    model.scale = i % 4 == 3 ? rng.uniform(1.1, 1.4) : rng.uniform(1.55, 1.92);
    model.size = {0.52 * model.scale, 0.40 * model.scale, 1.0 * model.scale};
    model.wheelbase = 0.3;
    model.shapes = {world.addShape(makeTorso(i % 3 == 0, i % 3 == 1)), arm, thigh, shank};
    world.people.push_back(static_cast<int>(world.bodies.size()));
    world.bodies.push_back(model);
  }
  BodyModel cyclist;
  cyclist.object_class = ObjectClass::cyclist;
  cyclist.gait = BodyModel::Gait::cycling;
  cyclist.size = {1.76, 0.64, 1.8};
  cyclist.wheelbase = 1.04;
  cyclist.shapes = {world.addShape(makeBicycle(true)), thigh, shank};
  world.cyclists.push_back(static_cast<int>(world.bodies.size()));
  world.bodies.push_back(cyclist);
}
}  // namespace

int World::addShape(Mesh mesh)
{
  shape_meshes.push_back(std::move(mesh));
  shapes.emplace_back(device.handle());
  shapes.back().addMesh(shape_meshes.back(), {});
  shapes.back().commit(RTC_BUILD_QUALITY_MEDIUM);
  return static_cast<int>(shapes.size()) - 1;
}

void World::place(int shape,
                  const Eigen::Affine3f& transform,
                  std::uint16_t semantic,
                  std::uint16_t instance,
                  float reflectivity)
{
  SceneItem item;
  item.semantic = semantic;
  item.instance = instance;
  item.reflectivity = reflectivity;
  placements_.push_back({shape, transform, item});
}

void World::placeOnGround(int shape, const Eigen::Vector2d& position, double yaw, float scale)
{
  const Eigen::Vector3d p(position.x(), position.y(), ground->height(position));
  Eigen::Affine3f transform = Eigen::Affine3f::Identity();
  transform.translate(p.cast<float>());
  transform.rotate(Eigen::AngleAxisf(static_cast<float>(yaw), Eigen::Vector3f::UnitZ()));
  transform.scale(scale);
  place(shape, transform);
}

void World::park(int model_index, const Eigen::Vector2d& position, double yaw, Rng& rng)
{
  const BodyModel& model = bodies[static_cast<std::size_t>(model_index)];
  // The body is aligned with the ground below its axles.
  const Eigen::Vector2d forward(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  const double h = 0.5 * model.wheelbase, w = 0.4 * model.size.y();
  const double front = ground->height(position + h * forward),
               back = ground->height(position - h * forward);
  const double port = ground->height(position + w * left),
               starboard = ground->height(position - w * left);
  BodyState state;
  state.position = {position.x(), position.y(), 0.5 * (front + back)};
  state.yaw = yaw;
  state.pitch = -std::atan2(front - back, 2 * h);
  state.roll = std::atan2(port - starboard, 2 * w);
  const auto semantic = semanticClasses(model.object_class).first;
  const auto instance = nextInstance();
  const float paint = drawPaint(rng);
  for (const auto& part : bodyParts(model, state))
  {
    place(part.shape, part.transform.cast<float>(), semantic, instance, paint);
  }
}

void World::finish()
{
  for (const auto& mesh : meshes)
  {
    if (!mesh.empty())
    {
      scene.addMesh(mesh, {});
    }
  }
  for (const auto& p : placements_)
  {
    scene.addInstance(shapes[static_cast<std::size_t>(p.shape)], p.transform, nullptr, p.item);
  }
  placements_.clear();
  scene.commit(RTC_BUILD_QUALITY_MEDIUM);
}

void addBodies(World& world, Rng& rng)
{
  for (int i = 0; i < 9; ++i)
  {
    const CarStyle style = drawCarStyle(rng);
    world.cars.push_back(
        addRigid(world, makeCar(style), ObjectClass::car, 0.6 * static_cast<double>(style.length)));
  }
  for (int i = 0; i < 3; ++i)
  {
    const CarStyle style = drawVanStyle(rng);
    world.vans.push_back(
        addRigid(world, makeCar(style), ObjectClass::van, 0.6 * static_cast<double>(style.length)));
  }
  for (int i = 0; i < 4; ++i)
  {
    const bool trailer = i >= 2;
    const float length =
        static_cast<float>(trailer ? rng.uniform(14.0, 16.5) : rng.uniform(7.0, 10.0));
    const float height = static_cast<float>(rng.uniform(3.2, 4.0));
    world.trucks.push_back(addRigid(world, makeTruck(length, 2.5F, height, trailer),
                                    ObjectClass::truck, 0.55 * static_cast<double>(length)));
  }
  for (int i = 0; i < 2; ++i)
  {
    const float length = static_cast<float>(rng.uniform(10.5, 12.2));
    world.buses.push_back(
        addRigid(world, makeBus(length, 2.55F, static_cast<float>(rng.uniform(3.0, 3.25))),
                 ObjectClass::bus, 0.5 * static_cast<double>(length)));
  }
  world.riders.push_back(addRigid(world, makeScooter(true), ObjectClass::motorcyclist, 1.3));
  world.parked_bicycles.push_back(addRigid(world, makeBicycle(false), ObjectClass::unknown, 1.04));
  addPeople(world, rng);
}

int drawVehicle(const World& world, Rng& rng, const VehicleMix& mix)
{
  const double u = rng.uniform();
  if (u < mix.heavy)
  {
    return rng.chance(0.25) ? rng.pick(world.buses) : rng.pick(world.trucks);
  }
  if (u < mix.heavy + mix.vans)
  {
    return rng.pick(world.vans);
  }
  return u > 1 - mix.riders ? rng.pick(world.riders) : rng.pick(world.cars);
}

float drawPaint(Rng& rng)
{
  return static_cast<float>(rng.chance(0.35) ? rng.uniform(0.05, 0.15) : rng.uniform(0.2, 0.75));
}

std::pair<std::uint16_t, std::uint16_t> semanticClasses(ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::car:
    case ObjectClass::van:
      return {10, 252};
    case ObjectClass::truck:
      return {18, 258};
    case ObjectClass::bus:
      return {13, 257};
    case ObjectClass::motorcyclist:
      return {32, 255};
    case ObjectClass::cyclist:
      return {31, 253};
    case ObjectClass::pedestrian:
      return {30, 254};
    case ObjectClass::unknown:
      break;
  }
  return {11, 11};  // the only unknown bodies are bicycles without a rider
}

std::shared_ptr<const World> makeWorld(const SimulatorOptions& options)
{
  validate(options, "simulator");
  if (options.reverse &&
      (options.world == WorldKind::highway || options.world == WorldKind::tunnel))
  {
    throw UserError("simulator.reverse: a " + toString(options.world) +
                    " has one direction; choose urban, downtown, campus, field or indoor");
  }
  auto world = std::make_shared<World>(options.world, static_cast<std::uint64_t>(options.seed));
  Rng rng(combine(world->seed, 0xB0D1E5));
  addBodies(*world, rng);
  switch (options.world)
  {
    case WorldKind::urban:
      buildUrban(*world, options);
      break;
    case WorldKind::campus:
      buildCampus(*world, options);
      break;
    case WorldKind::highway:
    case WorldKind::tunnel:
      buildHighway(*world, options);
      break;
    case WorldKind::field:
      buildField(*world, options);
      break;
    case WorldKind::downtown:
      buildDowntown(*world, options);
      break;
    case WorldKind::indoor:
      buildIndoor(*world, options);
      break;
  }
  world->finish();
  return world;
}
}  // namespace dyslam::sim
