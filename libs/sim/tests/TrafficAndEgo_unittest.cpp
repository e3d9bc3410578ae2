// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include "TestScans.h"

namespace
{
using namespace dyslam;
using namespace dyslam::sim;

/** Whether two slightly shrunk vehicle boxes overlap (separating axis theorem). */
bool collide(const Box& a, const Box& b)
{
  const auto axes = [](const Box& x)
  {
    return std::array<Eigen::Vector2d, 2>{Eigen::Vector2d(std::cos(x.yaw), std::sin(x.yaw)),
                                          Eigen::Vector2d(-std::sin(x.yaw), std::cos(x.yaw))};
  };
  const auto extent = [&](const Box& x, const Eigen::Vector2d& axis)
  {
    const auto u = axes(x);
    return 0.45 * (x.size.x() * std::abs(u[0].dot(axis)) + x.size.y() * std::abs(u[1].dot(axis)));
  };
  for (const Box* x : {&a, &b})
  {
    for (const auto& axis : axes(*x))
    {
      if (std::abs(axis.dot((a.centre - b.centre).head<2>())) > extent(a, axis) + extent(b, axis))
      {
        return false;
      }
    }
  }
  return true;
}

TEST(Traffic, VehiclesDoNotCollide)
{
  for (const auto world : {WorldKind::urban, WorldKind::highway, WorldKind::downtown})
  {
    for (const double traffic : {0.4, 1.0})
    {
      SimulatorOptions options = small(world, traffic);
      options.columns = 8;
      Simulator simulator(options);
      std::size_t pairs = 0, clashes = 0, ego_clashes = 0;
      double fastest = 0;
      for (int i = 0; i < 300; ++i)
      {
        const SimulatedScan s = simulator.next();
        Box ego;
        ego.size = {4.4, 1.8, 1.5};
        for (std::size_t k = 0; k < s.objects.size(); ++k)
        {
          const auto vehicle = [](const SimulatedObject& o) {
            return o.object_class != ObjectClass::pedestrian &&
                   o.object_class != ObjectClass::cyclist;
          };
          fastest = std::max(fastest, s.objects[k].velocity.norm());
          if (!vehicle(s.objects[k]))
          {
            continue;
          }
          ego_clashes += collide(ego, s.objects[k].box) ? 1 : 0;
          for (std::size_t l = 0; l < k; ++l)
          {
            if (vehicle(s.objects[l]) &&
                (s.objects[k].box.centre - s.objects[l].box.centre).norm() < 20)
            {
              ++pairs;
              clashes += collide(s.objects[k].box, s.objects[l].box) ? 1 : 0;
            }
          }
        }
      }
      EXPECT_GT(pairs, 300U) << toString(world) << " " << traffic;
      EXPECT_LE(static_cast<double>(clashes), 0.01 * static_cast<double>(pairs))
          << toString(world) << " " << traffic;
      EXPECT_EQ(ego_clashes, 0U) << toString(world) << " " << traffic;
      EXPECT_LT(fastest, 45);
    }
  }
}

struct RangeAndHeight
{
  double range;   // from the lidar [m]
  double height;  // of the centre, map frame [m]
};

/** Bodies within 300 m at the first scan, by id. \param start of the ego on its loop, 0 to 1 */
std::map<int, RangeAndHeight> firstSeenFrom(double start, SimulatorOptions options)
{
  options.start_fraction = start;
  options.max_range = 300;
  const SimulatedScan scan = Simulator(options).next();
  const Pose T_map_lidar = scan.T_map_vehicle * scan.scan.T_vehicle_lidar;
  std::map<int, RangeAndHeight> bodies;
  for (const SimulatedObject& object : scan.objects)
  {
    bodies[object.id] = {object.box.centre.norm(), (T_map_lidar * object.box.centre).z()};
  }
  return bodies;
}

TEST(Traffic, BodiesTooFarAwayToBeSimulatedStandOnTheGround)
{
  SimulatorOptions options = small(WorldKind::campus, 1);
  options.columns = 8;
  options.loop_length = 1500;
  options.start_time = 0;
  const auto from_here = firstSeenFrom(0, options);
  std::size_t compared = 0;
  for (const auto& [id, there] : firstSeenFrom(0.25, options))
  {
    const auto found = from_here.find(id);
    if (found != from_here.end() && found->second.range > 240 && there.range < 200)
    {
      EXPECT_NEAR(found->second.height, there.height, 0.15) << id;
      ++compared;
    }
  }
  EXPECT_GT(compared, 10U);
}

TEST(Ego, IsOnItsLoopFromTheBeginning)
{
  SimulatorOptions options = small(WorldKind::urban, 0);
  options.start_time = 0;
  const SimulatedScan scan = Simulator(options).next();
  std::size_t compared = 0;
  for (std::size_t i = 0; i < scan.scan.size(); ++i)
  {
    const Eigen::Vector3f& point = scan.scan.points[i];
    if (point.norm() < 20)
    {
      EXPECT_LT((scan.deskewed[i] - point).norm(), 1.5) << "more than the motion of 0.05 s";
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000U);
}

TEST(Ego, ClosesItsLoop)
{
  for (const auto world :
       {WorldKind::urban, WorldKind::downtown, WorldKind::campus, WorldKind::field})
  {
    SimulatorOptions options = small(world, 0);
    options.columns = 8;
    options.stops = false;
    options.ego_speed = world == WorldKind::campus || world == WorldKind::field ? 4 : 12;
    options.ego = world == WorldKind::campus ? EgoKind::handheld : EgoKind::automatic;
    Simulator simulator(options);
    SimulatedScan s = simulator.next();
    const Eigen::Vector3d start = s.T_map_vehicle.translation();
    Eigen::Vector3d last = start;
    double driven = 0, farthest = 0, nearest_again = 1e9;
    for (int i = 0; i < 3000 && driven < 1.05 * simulator.loopLength(); ++i)
    {
      s = simulator.next();
      const Eigen::Vector3d here = s.T_map_vehicle.translation();
      driven += (here - last).norm();
      farthest = std::max(farthest, (here - start).norm());
      if (driven > 0.8 * simulator.loopLength())
      {
        nearest_again = std::min(nearest_again, (here - start).norm());
      }
      last = here;
    }
    EXPECT_GT(driven, 0.9 * simulator.loopLength()) << toString(world);
    EXPECT_GT(farthest, 25) << toString(world);
    EXPECT_LT(nearest_again, 1.5) << toString(world);
  }
}

SimulatorOptions fewRays(WorldKind world, double traffic, int seed)
{
  SimulatorOptions o = small(world, traffic);
  o.sensor = SensorKind::vlp16;
  o.columns = 16;
  o.loop_length = 500;
  o.seed = seed;
  return o;
}

/** Standard deviation of a signal, and its autocorrelation after `lag` samples. */
std::pair<double, double> deviationAndCorrelation(const std::vector<double>& x, std::size_t lag)
{
  const auto n = static_cast<double>(x.size());
  double mean = 0, square = 0, product = 0;
  for (const double v : x)
  {
    mean += v / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i)
  {
    square += (x[i] - mean) * (x[i] - mean);
    product += i + lag < x.size() ? (x[i] - mean) * (x[i + lag] - mean) : 0;
  }
  return {std::sqrt(square / n), product / square};
}

// OXTS of the KITTI tracking data, 17 sequences above 5 m/s: standard deviations from 0.006 to
// 0.026 rad/s, mostly 0.012 to 0.020; correlation after 0.1 s from 0.47 to 0.82.
TEST(Ego, PitchesAndRollsAsARealCar)
{
  for (const WorldKind world : {WorldKind::urban, WorldKind::highway})
  {
    SimulatorOptions options = fewRays(world, 0, 8);
    options.stops = false;
    Simulator simulator(options, 2);
    std::vector<double> roll, pitch;
    for (int i = 0; i < 400; ++i)
    {
      const SimulatedScan scan = simulator.next();
      const Pose motion = scan.T_map_vehicle.inverse() * scan.T_map_vehicle_next;
      const Eigen::AngleAxisd turn(motion.linear());
      roll.push_back(turn.angle() * turn.axis().x() / 0.1);
      pitch.push_back(turn.angle() * turn.axis().y() / 0.1);
    }
    for (const auto& rate : {roll, pitch})
    {
      const auto [deviation, correlation] = deviationAndCorrelation(rate, 1);
      EXPECT_GT(deviation, 0.006) << toString(world);
      EXPECT_LT(deviation, 0.026) << toString(world);
      EXPECT_GT(correlation, 0.45) << toString(world);
      EXPECT_LT(correlation, 0.85) << toString(world);
    }
  }
}

TEST(Ego, DrivesMostOfTheTimeInTraffic)
{
  for (const int seed : {7711, 7712, 7713})
  {
    Simulator simulator(fewRays(WorldKind::urban, 0.4, seed), 2);
    double driven = 0;
    int stood = 0;
    for (int i = 0; i < 400; ++i)
    {
      const SimulatedScan scan = simulator.next();
      const double step =
          (scan.T_map_vehicle.inverse() * scan.T_map_vehicle_next).translation().norm();
      driven += step;
      stood += step < 0.02 ? 1 : 0;
    }
    EXPECT_GT(driven, 80) << "seed " << seed;
    EXPECT_LT(stood, 160) << "seed " << seed;
  }
}
}  // namespace
