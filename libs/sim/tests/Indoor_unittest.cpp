// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "TestScans.h"
#include "traffic/Traffic.h"
#include "worlds/FloorPlan.h"
#include "worlds/World.h"

namespace
{
using namespace dyslam;
using namespace dyslam::sim;
using P = Eigen::Vector2d;

SimulatorOptions indoor(int seed, double traffic)
{
  SimulatorOptions o;
  o.world = WorldKind::indoor;
  o.sensor = SensorKind::os1_32;
  o.columns = 256;
  o.traffic = traffic;
  o.loop_length = 200;
  o.seed = seed;
  return o;
}

TEST(FloorPlan, ClearanceFurnitureAndReservedWays)
{
  FloorPlan plan({{0, 0}, {10, 8}}, 0.1);
  EXPECT_FALSE(plan.empty());
  plan.free({{1, 1}, {9, 7}});
  plan.reserve({1, 4}, {9, 4}, 0.5);
  EXPECT_FALSE(plan.available({{2, 3.8}, {3, 4.2}}));  // on the way
  EXPECT_FALSE(plan.available({{0.5, 2}, {1.5, 3}}));  // in the wall
  EXPECT_TRUE(plan.available({{5, 1.5}, {6, 2.5}}));
  plan.block({{5, 1.5}, {6, 2.5}});
  EXPECT_FALSE(plan.available({{5.5, 2}, {6.5, 3}}));
  plan.measureClearance();
  EXPECT_NEAR(plan.clearance({1.55, 4}), 0.55, 0.11);
  EXPECT_NEAR(plan.clearance({5.5, 3.05}), 0.55, 0.11);                  // above the furniture
  EXPECT_NEAR(plan.clearance({6.85, 3.35}), std::sqrt(2) * 0.85, 0.16);  // beyond its corner
  EXPECT_EQ(plan.clearance({5.5, 2}), 0);
  EXPECT_EQ(plan.clearance({-3, 2}), 0);
  EXPECT_GT(plan.away({1.4, 4}).x(), 0.95);
  EXPECT_LT(plan.away({5.5, 1.2}).norm(), 1.01);
  EXPECT_TRUE(plan.isClear({2, 4}, {8, 4}, 0.9));
  EXPECT_FALSE(plan.isClear({2, 2}, {8, 2}, 0.1));
}

TEST(Indoor, TheEgoIsAtADistanceFromWallsAndFurnitureOnALoopOfTheLengthAskedFor)
{
  for (const double length : {150.0, 200.0, 400.0, 600.0})
  {
    for (const int seed : {1, 2, 3})
    {
      SimulatorOptions options = indoor(seed, 0);
      options.loop_length = length;
      const auto world = makeWorld(options);
      EXPECT_NEAR(world->loop_length, length, 0.1 * length) << seed;
      double least = 1e9;
      for (double s = 0; s < world->loop_length; s += 0.2)
      {
        least = std::min(least, world->floor_plan.clearance(world->ego_path.at(s).position));
      }
      EXPECT_GT(least, 0.9) << length << " m, seed " << seed;
    }
  }
}

TEST(Indoor, ScansOfALoopShowFloorCeilingAndWallsButNothingOnThePath)
{
  SimulatorOptions options = indoor(3, 0);
  options.noise = false;
  options.stops = false;
  options.ego_speed = 5;
  options.columns = 64;
  Simulator simulator(options, 2);
  double travelled = 0, nearest = 1e9, highest = 0;
  std::size_t scans = 0, ceilings = 0, scans_with_floor = 0;
  P start = P::Zero(), last = P::Zero();
  while (travelled < simulator.loopLength() && scans < 600)
  {
    const SimulatedScan s = simulator.next();
    const P here = s.T_map_vehicle.translation().head<2>();
    start = scans == 0 ? here : start;
    travelled += scans == 0 ? 0 : (here - last).norm();
    last = here;
    ++scans;
    const Pose T_map_lidar = s.T_map_vehicle * s.scan.T_vehicle_lidar;
    std::size_t floor = 0, ceiling = 0;
    for (std::size_t k = 0; k < s.deskewed.size(); ++k)
    {
      const Eigen::Vector3d p = T_map_lidar * s.deskewed[k].cast<double>();
      const std::uint32_t label = s.label[k] & 0xFFFFU;
      floor += label == 49 ? 1 : 0;
      ceiling += label == 50 && p.z() > 2.7 ? 1 : 0;
      EXPECT_TRUE(label != 49 || std::abs(p.z()) < 0.05) << p.z();
      if (p.z() > 0.1 && p.z() < 2)
      {
        nearest = std::min(nearest, (p.head<2>() - here).norm());
      }
      highest = std::max(highest, p.z());
    }
    scans_with_floor += floor > 50 ? 1 : 0;
    ceilings += ceiling > 20 ? 1 : 0;
  }
  EXPECT_GE(travelled, simulator.loopLength());
  EXPECT_LT((last - start).norm(), 3);
  EXPECT_EQ(scans_with_floor, scans);
  EXPECT_GT(ceilings, scans * 9 / 10);
  EXPECT_GT(nearest, 0.8);
  EXPECT_GT(highest, 6);  // the hall
  EXPECT_LT(highest, 12.1);
}

TEST(Indoor, PeopleWalkOnFreeFloorAndDoNotStandInEachOther)
{
  for (const double traffic : {0.4, 1.0})
  {
    const SimulatorOptions options = indoor(2, traffic);
    const auto world = makeWorld(options);
    Crowd crowd(*world, options);
    const std::size_t count = crowd.actors().size();
    EXPECT_GT(static_cast<double>(count), 150 * traffic);
    std::vector<P> first;
    for (const Actor& actor : crowd.actors())
    {
      first.push_back(actor.state.position.head<2>());
    }
    std::size_t samples = 0, close = 0, in_ego = 0, walking = 0;
    for (int step = 1; step <= 1200; ++step)
    {
      crowd.step(0.025);
      if (step % 40 != 0)
      {
        continue;
      }
      for (std::size_t i = 0; i < count; ++i)
      {
        const Actor& a = crowd.actors()[i];
        const P p = a.state.position.head<2>();
        ASSERT_GE(world->floor_plan.clearance(p), 0.15) << p.transpose();
        ++samples;
        walking += a.state.speed > 0.4 ? 1 : 0;
        in_ego += (p - crowd.ego().position).norm() < 0.35 ? 1 : 0;
        for (std::size_t k = 0; k < i; ++k)
        {
          close += (crowd.actors()[k].state.position.head<2>() - p).norm() < 0.3 ? 1 : 0;
        }
      }
    }
    EXPECT_LT(static_cast<double>(close), 0.005 * static_cast<double>(samples)) << traffic;
    EXPECT_GT(static_cast<double>(walking), 0.35 * static_cast<double>(samples)) << traffic;
    EXPECT_EQ(in_ego, 0U) << traffic;
    std::size_t went_far = 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      went_far += (crowd.actors()[i].state.position.head<2>() - first[i]).norm() > 6 ? 1 : 0;
    }
    EXPECT_GT(went_far, count / 4) << traffic;
  }
}

TEST(Indoor, SuitcasesTrolleysQueuesAndMachines)
{
  std::set<int> models;
  std::size_t queues = 0, machines = 0;
  for (const int seed : {1, 2, 3, 4})
  {
    const SimulatorOptions options = indoor(seed, 0.6);
    const auto world = makeWorld(options);
    queues += world->queues.size();
    const Crowd crowd(*world, options);
    for (const Actor& actor : crowd.actors())
    {
      const auto& t = world->travellers;
      const auto found = std::find(t.begin(), t.end(), actor.model);
      if (found != t.end())
      {
        models.insert(static_cast<int>(found - t.begin()));
      }
      machines += actor.model == world->machines.front() ? 1 : 0;
    }
  }
  EXPECT_EQ(models.size(), 6U);
  EXPECT_GT(queues, 2U);
  EXPECT_GT(machines, 2U);
}

TEST(Indoor, PointsOfPeopleAndMachinesAreInTheirBoxesAndHaveTheirClasses)
{
  SimulatorOptions options = indoor(4, 0.8);
  options.noise = false;
  options.columns = 1024;
  options.motion_distortion = false;
  Simulator simulator(options, 2);
  std::size_t inside = 0, all = 0;
  std::map<std::uint32_t, std::size_t> points;  // by class
  for (int i = 0; i < 60; ++i)
  {
    const SimulatedScan s = simulator.next();
    if (i % 10 != 0)
    {
      continue;
    }
    std::map<std::uint32_t, const SimulatedObject*> objects;
    for (const SimulatedObject& o : s.objects)
    {
      objects[static_cast<std::uint32_t>(o.id)] = &o;
    }
    for (std::size_t k = 0; k < s.label.size(); ++k)
    {
      const auto object = objects.find(s.label[k] >> 16);
      if (object == objects.end() || s.label[k] >> 16 == 0)
      {
        continue;
      }
      ++points[s.label[k] & 0xFFFFU];
      const Box& box = object->second->box;
      const Eigen::Vector3d p = Eigen::AngleAxisd(-box.yaw, Eigen::Vector3d::UnitZ()) *
                                (s.deskewed[k].cast<double>() - box.centre);
      // Limbs swing beyond a person's box.
      ++all;
      inside += std::abs(p.x()) < 0.5 * box.size.x() + 0.25 &&
                        std::abs(p.y()) < 0.5 * box.size.y() + 0.1 &&
                        std::abs(p.z()) < 0.5 * box.size.z() + 0.1
                    ? 1
                    : 0;
    }
  }
  EXPECT_GT(all, 10000U);
  EXPECT_GT(static_cast<double>(inside), 0.98 * static_cast<double>(all));
  EXPECT_GT(points[254], 5000U);  // moving person
  EXPECT_GT(points[30], 500U);    // person at rest
}

TEST(Indoor, TheOtherWayRound)
{
  SimulatorOptions options = indoor(5, 0);
  options.stops = false;
  const auto heading = [](const SimulatorOptions& o)
  {
    const Pose pose = Simulator(o, 1).next().T_map_vehicle;
    return Eigen::Vector3d(pose.linear().col(0));
  };
  options.start_fraction = 0.6;  // in a straight corridor, not at the start
  options.start_time = 0;
  SimulatorOptions other = options;
  other.reverse = true;
  EXPECT_LT(heading(options).dot(heading(other)), -0.9);
}

TEST(Indoor, RefusesCarsAndLoopsThatNoBuildingHas)
{
  SimulatorOptions options = indoor(1, 0);
  options.ego = EgoKind::car;
  EXPECT_THROW(Simulator(options, 1), UserError);
  options.ego = EgoKind::handheld;
  EXPECT_NO_THROW(Simulator(options, 1));
  options.loop_length = 100;
  EXPECT_THROW(Simulator(options, 1), UserError);
  options.loop_length = 700;
  EXPECT_THROW(Simulator(options, 1), UserError);
}
}  // namespace
