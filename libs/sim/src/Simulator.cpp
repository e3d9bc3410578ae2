// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/sim/Simulator.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "sensor/EgoMotion.h"
#include "sensor/MotionSampler.h"
#include "sensor/Sweep.h"
#include "traffic/Traffic.h"

namespace dyslam::sim
{
namespace
{
constexpr double kStep = 0.025;          // time step of traffic and ego [s]
constexpr double kEpoch = 1700000000.0;  // offset of the stamps, as in recorded data [s]
constexpr double kJump = 15;             // larger displacements in one sweep are respawns [m]

EgoKind carrierOf(const SimulatorOptions& options)
{
  if (options.ego != EgoKind::automatic)
  {
    return options.ego;
  }
  return options.world == WorldKind::campus || options.world == WorldKind::indoor ? EgoKind::robot
                                                                                  : EgoKind::car;
}

/** T_vehicle_lidar with the mounting angles of the options. */
Pose mountingFor(const SimulatorOptions& o)
{
  const Pose upright = EgoMotion::mounting(carrierOf(o));
  return o.mounting_roll == 0 && o.mounting_pitch == 0
             ? upright  // exactly the default, so that recordings keep their bytes
             : upright * poseFromYpr(0, 0, 0, 0, o.mounting_pitch, o.mounting_roll);
}

/** A further sensor of the ego. */
struct FurtherLidar
{
  SensorModel model;
  Pose T_vehicle_lidar;
};

/** The model of a sensor with the range of the options. \throws UserError. */
SensorModel modelFor(SensorKind kind, const SimulatorOptions& options)
{
  SensorModel model = sensorModel(kind);
  if (options.max_range > 0 && options.max_range <= model.min_range)
  {
    throw UserError("simulator.max_range: is not above the least range of the " + model.name +
                    "; choose a larger one");
  }
  model.max_range = options.max_range > 0 ? options.max_range : model.max_range;
  return model;
}

std::vector<FurtherLidar> furtherLidarsOf(const SimulatorOptions& options)
{
  std::map<std::string, int> labels{{sensorModel(options.sensor).name, 1}};
  std::vector<FurtherLidar> lidars;
  for (const FurtherSensor& further : options.further_sensors)
  {
    FurtherLidar lidar{modelFor(further.sensor, options), further.T_vehicle_lidar};
    const int count = ++labels[lidar.model.name];
    lidar.model.name += count > 1 ? "_" + std::to_string(count) : "";
    lidars.push_back(lidar);
  }
  return lidars;
}

SensorModel sensorFor(const SimulatorOptions& options)
{
  SensorModel sensor = modelFor(options.sensor, options);
  sensor.columns = options.columns > 0 ? options.columns : sensor.columns;
  return sensor;
}
}  // namespace

struct Simulator::Impl
{
  Impl(std::shared_ptr<const World> w, const SimulatorOptions& o, int threads)
      : options(o),
        world(std::move(w)),
        model(sensorFor(o)),
        pool(threads),
        crowd(*world, options),
        ego_motion(carrierOf(o), o.trafficSeed()),
        motion_sampler(o),
        T_vehicle_lidar(mountingFor(o)),
        further_lidars(furtherLidarsOf(o)),
        moving_scene(world->device.handle())
  {
    do  // one step at least, which places the vehicle
    {
      stepOnce();
    } while (crowd.time() < options.start_time);
    steps_per_sweep = static_cast<int>(std::lround(model.period / kStep));
    track.assign(1, ego_pose);
    states.push_back(snapshot());
    advanceSweep();
    advanceSweep();
  }

  void stepOnce()
  {
    crowd.step(kStep);
    ego_pose = ego_motion.update(crowd.ego(), *world->ground, crowd.time(), kStep);
  }

  std::vector<BodyState> snapshot()
  {
    crowd.alignWithGround();
    std::vector<BodyState> s;
    s.reserve(crowd.actors().size());
    for (const auto& a : crowd.actors())
    {
      s.push_back(a.state);
    }
    return s;
  }

  void advanceSweep()
  {
    for (int i = 0; i < steps_per_sweep; ++i)
    {
      stepOnce();
      track.push_back(ego_pose);
    }
    states.push_back(snapshot());
  }

  /** Vehicle pose `t` seconds after the start of the current sweep. */
  Pose vehicleAt(double t) const
  {
    const double x = t / kStep;
    const auto i = std::min(static_cast<std::size_t>(std::max(0.0, x)), track.size() - 2);
    return interpolate(track[i], track[i + 1], x - static_cast<double>(i));
  }

  /** Largest range of all sensors [m]. */
  double maxRange() const
  {
    double range = model.max_range;
    for (const FurtherLidar& lidar : further_lidars)
    {
      range = std::max(range, lidar.model.max_range);
    }
    return range;
  }

  double stampOf(std::size_t scan) const
  {
    return kEpoch + model.period * (static_cast<double>(scan) + 0.5);
  }

  SimulatedScan next();
  [[nodiscard]] SweepScene sweepOf(const SimulatedScan& scan,
                                   const SensorModel& sensor,
                                   const Pose& mounting) const;
  void castFurther(const SweepScene& first,
                   SimulatedScan& scan,
                   std::vector<BodyReturns>& body_returns);
  void sampleMotion();
  void gatherBodies(const Eigen::Vector3d& centre);
  void describeObjects(const SweepScene& sweep,
                       const std::vector<BodyReturns>& body_returns,
                       SimulatedScan& scan) const;

  SimulatorOptions options;
  std::shared_ptr<const World> world;
  SensorModel model;
  ThreadPool pool;
  Crowd crowd;
  EgoMotion ego_motion;
  MotionSampler motion_sampler;
  Pose T_vehicle_lidar;
  std::vector<FurtherLidar> further_lidars;
  RayScene moving_scene;
  Pose ego_pose = Pose::Identity();
  int steps_per_sweep = 0;
  std::vector<Pose> track;  // vehicle poses from the start of the sweep, every kStep
  std::vector<std::vector<BodyState>>
      states;                      // body states at the start, end and next end of the sweep
  std::vector<BodyMotion> bodies;  // bodies within range
  std::vector<std::size_t> body_actor;
  std::size_t index = 0;
  // Samples after the current scan's stamp: they belong to the next scan.
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
};

void Simulator::Impl::sampleMotion()
{
  MotionBetweenScans motion;
  motion.stamp = stampOf(index);
  motion.next_stamp = stampOf(index + 1);
  motion.vehicleAt = [&](double t) { return vehicleAt(0.5 * model.period + t); };
  motion.step = kStep;
  if (options.imu)
  {
    imu = motion_sampler.imu(motion);
  }
  if (options.wheels)
  {
    wheels = motion_sampler.wheels(motion);
  }
}

void Simulator::Impl::gatherBodies(const Eigen::Vector3d& centre)
{
  bodies.clear();
  body_actor.clear();
  moving_scene.clear();
  const double reach = maxRange() + 12;
  for (std::size_t i = 0; i < crowd.actors().size(); ++i)
  {
    const BodyState &a = states[0][i], &b = states[1][i], &c = states[2][i];
    if ((a.position - centre).head<2>().norm() > reach ||
        (b.position - a.position).norm() > kJump || (c.position - b.position).norm() > kJump)
    {
      continue;
    }
    const Actor& actor = crowd.actors()[i];
    const BodyModel& body_model = world->bodies[static_cast<std::size_t>(actor.model)];
    BodyMotion body;
    // Only translation over ground counts as motion, not rotation in place.
    body.moving = (b.position - a.position).norm() / model.period > options.moving_speed;
    const auto classes = body_model.semantic_moving != 0
                             ? std::pair(body_model.semantic_at_rest, body_model.semantic_moving)
                             : semanticClasses(body_model.object_class);
    body.semantic = body.moving ? classes.second : classes.first;
    body.instance = static_cast<std::uint16_t>(65535 - i % kMovingInstances);
    const bool at_rest = !body.moving && (b.position - a.position).norm() < 1e-6 &&
                         std::abs(b.yaw - a.yaw) < 1e-6 && std::abs(b.phase - a.phase) < 1e-6 &&
                         b.swing == a.swing;
    const auto parts_a = bodyParts(body_model, a), parts_b = bodyParts(body_model, b),
               parts_c = bodyParts(body_model, c);
    for (std::size_t p = 0; p < parts_a.size(); ++p)
    {
      body.parts.push_back({parts_a[p].transform, parts_b[p].transform, parts_c[p].transform});
      SceneItem item;
      item.reflectivity = actor.paint;
      item.body = static_cast<std::int32_t>(bodies.size());
      item.part = static_cast<std::int32_t>(p);
      const Eigen::Affine3f start = parts_a[p].transform.cast<float>(),
                            end = parts_b[p].transform.cast<float>();
      moving_scene.addInstance(world->shapes[static_cast<std::size_t>(parts_a[p].shape)], start,
                               at_rest ? nullptr : &end, item);
    }
    bodies.push_back(std::move(body));
    body_actor.push_back(i);
  }
  moving_scene.commit(RTC_BUILD_QUALITY_LOW);
}

void Simulator::Impl::describeObjects(const SweepScene& sweep,
                                      const std::vector<BodyReturns>& body_returns,
                                      SimulatedScan& scan) const
{
  const Pose T_lidar_map = sweep.T_map_lidar.inverse();
  for (std::size_t i = 0; i < bodies.size(); ++i)
  {
    const std::size_t actor = body_actor[i];
    const BodyModel& m = world->bodies[static_cast<std::size_t>(crowd.actors()[actor].model)];
    const BodyState &a = states[0][actor], &b = states[1][actor];
    SimulatedObject o;
    o.id = static_cast<int>(bodies[i].instance);
    o.object_class = m.object_class;
    o.moving = bodies[i].moving;
    o.points = body_returns[i].points;
    o.seen_time = o.points > 0 ? body_returns[i].time / static_cast<double>(o.points) : 0;
    o.velocity = T_lidar_map.linear() * (b.position - a.position) / model.period;
    const auto boxAt = [&](double time)
    {
      const Pose pose = interpolate(bodyPose(a), bodyPose(b), time / model.period + 0.5);
      Box box;
      box.size = m.size;
      box.centre = T_lidar_map * (pose * Eigen::Vector3d(m.centre_x, 0, 0.5 * m.size.z()));
      const Eigen::Vector3d heading = T_lidar_map.linear() * pose.linear().col(0);
      box.yaw = std::atan2(heading.y(), heading.x());
      return box;
    };
    o.box = boxAt(0);
    o.box_seen = boxAt(o.seen_time);
    if (o.box.centre.norm() < maxRange())
    {
      scan.objects.push_back(o);
    }
  }
}

SweepScene Simulator::Impl::sweepOf(const SimulatedScan& scan,
                                    const SensorModel& sensor,
                                    const Pose& mounting) const
{
  SweepScene sweep;
  sweep.static_scene = &world->scene;
  sweep.moving_scene = &moving_scene;
  sweep.bodies = &bodies;
  sweep.T_map_lidar = scan.T_map_vehicle * mounting;
  sweep.T_map_lidar_next = scan.T_map_vehicle_next * mounting;
  sweep.start = sensor.period * static_cast<double>(index);
  sweep.seed = combine(combine(options.trafficSeed(), 0x5CA7), index);
  sweep.noise = options.noise;
  sweep.motion_distortion = options.motion_distortion;
  sweep.R_vehicle_lidar = mounting.linear().cast<float>();
  for (int c = 0; c < sensor.columns; ++c)
  {
    sweep.T_map_lidar_column.push_back(
        options.motion_distortion ? vehicleAt(sensor.period * c / sensor.columns) * mounting
                                  : sweep.T_map_lidar);
  }
  return sweep;
}

/** Adds the scans of the further sensors. \param first sweep of the first sensor */
void Simulator::Impl::castFurther(const SweepScene& first,
                                  SimulatedScan& scan,
                                  std::vector<BodyReturns>& body_returns)
{
  for (const FurtherLidar& lidar : further_lidars)
  {
    SweepScene sweep = sweepOf(scan, lidar.model, lidar.T_vehicle_lidar);
    sweep.seed = combine(first.seed, scan.further.size() + 1);
    SimulatedScan part;
    part.scan.stamp = scan.scan.stamp;
    part.scan.T_vehicle_lidar = lidar.T_vehicle_lidar;
    part.scan.sensor_label = lidar.model.name;
    const auto returns = castSweep(lidar.model, sweep, pool, part);
    for (std::size_t i = 0; i < returns.size(); ++i)
    {
      body_returns[i].points += returns[i].points;
      body_returns[i].time += returns[i].time;
    }
    const Eigen::Isometry3f T = (T_vehicle_lidar.inverse() * lidar.T_vehicle_lidar).cast<float>();
    const Eigen::Isometry3f T_next_further =
        (first.T_map_lidar_next.inverse() * sweep.T_map_lidar_next).cast<float>();
    for (std::size_t i = 0; i < part.deskewed.size(); ++i)
    {
      const Eigen::Vector3f next = T_next_further * (part.deskewed[i] + part.flow[i]);
      scan.deskewed.push_back(T * part.deskewed[i]);
      scan.flow.push_back(next - scan.deskewed.back());
    }
    scan.label.insert(scan.label.end(), part.label.begin(), part.label.end());
    scan.moving.insert(scan.moving.end(), part.moving.begin(), part.moving.end());
    scan.further.push_back(std::move(part.scan));
  }
}

SimulatedScan Simulator::Impl::next()
{
  SimulatedScan scan;
  scan.index = index;
  scan.scan.stamp = stampOf(index);
  scan.scan.T_vehicle_lidar = T_vehicle_lidar;
  scan.scan.sensor_label = model.name;
  scan.T_map_vehicle = vehicleAt(0.5 * model.period);
  scan.T_map_vehicle_next = vehicleAt(1.5 * model.period);
  scan.imu = std::exchange(imu, {});
  scan.wheels = std::exchange(wheels, {});
  sampleMotion();

  SweepScene sweep = sweepOf(scan, model, T_vehicle_lidar);
  sweep.on_car = options.noise && carrierOf(options) == EgoKind::car;
  gatherBodies(sweep.T_map_lidar.translation());
  auto body_returns = castSweep(model, sweep, pool, scan);
  castFurther(sweep, scan, body_returns);
  describeObjects(sweep, body_returns, scan);

  // Advance to the next sweep.
  track.erase(track.begin(), track.begin() + steps_per_sweep);
  states.erase(states.begin());
  advanceSweep();
  ++index;
  return scan;
}

Simulator::Simulator(const SimulatorOptions& options, int threads)
    : Simulator(makeWorld(options), options, threads)
{
}

Simulator::Simulator(std::shared_ptr<const World> world,
                     const SimulatorOptions& options,
                     int threads)
{
  validate(options, "simulator");
  if (world->kind != options.world)
  {
    throw std::logic_error("Simulator: the world is of another kind than the options say");
  }
  if (options.wheels && carrierOf(options) == EgoKind::handheld)
  {
    throw UserError("simulator.wheels: a hand-held sensor has none; choose the ego car or robot");
  }
  impl_ = std::make_unique<Impl>(std::move(world), options, threads);
}

Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

SimulatedScan Simulator::next()
{
  return impl_->next();
}

const SensorModel& Simulator::sensor() const
{
  return impl_->model;
}

const SimulatorOptions& Simulator::options() const
{
  return impl_->options;
}

double Simulator::loopLength() const
{
  return impl_->world->loop_length;
}

std::shared_ptr<const World> Simulator::world() const
{
  return impl_->world;
}
}  // namespace dyslam::sim
