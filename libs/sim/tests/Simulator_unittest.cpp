// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "TestScans.h"

namespace
{
using namespace dyslam;
using namespace dyslam::sim;

Pose lidarPose(const SimulatedScan& s)
{
  return s.T_map_vehicle * s.scan.T_vehicle_lidar;
}

Pose nextLidarPose(const SimulatedScan& s)
{
  return s.T_map_vehicle_next * s.scan.T_vehicle_lidar;
}

Eigen::Vector3d inBox(const Box& box, const Eigen::Vector3f& p)
{
  return Eigen::AngleAxisd(-box.yaw, Eigen::Vector3d::UnitZ()) * (p.cast<double>() - box.centre);
}

/** Position of a point in its body, computed in the map so that the sensor's tilt has no effect. */
Eigen::Vector3d inBody(const Pose& T_map_lidar, const Box& box, const Eigen::Vector3f& p)
{
  const Eigen::Vector3d heading =
      T_map_lidar.linear() * Eigen::Vector3d(std::cos(box.yaw), std::sin(box.yaw), 0);
  return Eigen::AngleAxisd(-std::atan2(heading.y(), heading.x()), Eigen::Vector3d::UnitZ()) *
         (T_map_lidar.linear() * (p.cast<double>() - box.centre));
}

TEST(Simulator, EqualSeedsGiveEqualBytesOnAnyNumberOfThreads)
{
  for (const auto world : {WorldKind::urban, WorldKind::campus, WorldKind::highway,
                           WorldKind::downtown, WorldKind::indoor})
  {
    Simulator one(small(world, 0.6), 1), three(small(world, 0.6), 3);
    SimulatorOptions other_seed = small(world, 0.6);
    other_seed.seed = 6;
    Simulator other(other_seed, 2);
    for (int i = 0; i < 4; ++i)
    {
      const SimulatedScan a = one.next(), b = three.next(), c = other.next();
      ASSERT_GT(a.scan.size(), 5000U) << toString(world);
      EXPECT_TRUE(sameScan(a, b)) << toString(world) << " scan " << i;
      EXPECT_FALSE(sameScan(a, c)) << toString(world) << " scan " << i;
    }
  }
}

TEST(Simulator, FurtherSensorsSeeTheSameScene)
{
  SimulatorOptions options = small(WorldKind::urban, 0.6);
  options.noise = false;
  options.further_sensors = {{SensorKind::vlp16, poseFromYpr(-1, 0.5, 1, 2, 0, 0)},
                             {SensorKind::vlp16, poseFromYpr(2, 0, 0.8, 0, 0.1, 0)}};
  Simulator simulator(options, 2);
  options.further_sensors.clear();
  Simulator first_only(options, 2);
  for (int n = 0; n < 3; ++n)
  {
    const SimulatedScan s = simulator.next();
    const SimulatedScan first = first_only.next();
    EXPECT_TRUE(sameBytes(s.scan.points, first.scan.points));
    ASSERT_EQ(s.further.size(), 2U);
    EXPECT_EQ(s.further[0].sensor_label, "VLP16");
    EXPECT_EQ(s.further[1].sensor_label, "VLP16_2");
    const std::size_t own = s.scan.size();
    ASSERT_EQ(s.label.size(), own + s.further[0].size() + s.further[1].size());
    ASSERT_EQ(s.flow.size(), s.label.size());
    ASSERT_EQ(s.deskewed.size(), s.label.size());
    // Static points have the flow of the first sensor's motion, whichever sensor saw them.
    const Eigen::Isometry3f T_next = (nextLidarPose(s).inverse() * lidarPose(s)).cast<float>();
    std::size_t moving = 0;
    for (std::size_t i = own; i < s.label.size(); ++i)
    {
      const Eigen::Vector3f expected = T_next * s.deskewed[i] - s.deskewed[i];
      moving += s.moving[i];
      EXPECT_TRUE(s.moving[i] != 0 || (s.flow[i] - expected).norm() < 2e-3F) << i;
    }
    EXPECT_GT(moving, 0U);
  }
}

TEST(Simulator, AFurtherSensorSeesObjectsBeyondTheRangeOfTheFirst)
{
  SimulatorOptions options = small(WorldKind::highway, 0.6);
  options.sensor = SensorKind::vlp16;
  options.further_sensors = {{SensorKind::pandar64, poseFromYpr(0.1, 0, 1.9, 0, 0, 0)}};
  Simulator simulator(options, 2);
  const SimulatedScan s = simulator.next();
  const auto far = [](const Eigen::Vector3d& p) { return p.norm() > 120; };
  EXPECT_GT(std::count_if(s.objects.begin(), s.objects.end(),
                          [&](const SimulatedObject& object)
                          { return object.points > 0 && far(object.box.centre); }),
            0);
  std::size_t moving = 0;
  for (std::size_t i = 0; i < s.moving.size(); ++i)
  {
    moving += s.moving[i] != 0 && far(s.deskewed[i].cast<double>()) ? 1U : 0U;
  }
  EXPECT_GT(moving, 0U);
}

TEST(Simulator, TheRoofOccludesRaysOfATiltedSensorBelowIt)
{
  // Rays from the vehicle: forwards below the bonnet's edge.
  const auto isBelowBonnet = [](const Eigen::Vector3f& ray)
  { return std::abs(std::atan2(ray.y(), ray.x())) < 0.2F && ray.z() < -0.45F; };
  for (const bool noise : {true, false})
  {
    SimulatorOptions options = small(WorldKind::urban, 0);
    options.mounting_pitch = 20 * M_PI / 180;
    options.noise = noise;
    const SimulatedScan s = Simulator(options, 2).next();
    const Eigen::Matrix3f R = s.scan.T_vehicle_lidar.linear().cast<float>();
    const auto below =
        std::count_if(s.scan.points.begin(), s.scan.points.end(),
                      [&](const Eigen::Vector3f& p) { return isBelowBonnet(R * p.normalized()); });
    EXPECT_TRUE(noise ? below == 0 : below > 100) << below << ", without noise there is no car";
  }
}

TEST(Simulator, TheSameWorldWithOtherTraffic)
{
  SimulatorOptions options = small(WorldKind::urban, 0.6);
  Simulator first(options, 2);
  options.traffic_seed = 77;
  Simulator second(options, 2);
  options.seed = 6;
  Simulator elsewhere(options, 2);
  EXPECT_EQ(first.loopLength(), second.loopLength());
  EXPECT_NE(first.loopLength(), elsewhere.loopLength());
  const SimulatedScan a = first.next();
  const SimulatedScan b = second.next();
  EXPECT_FALSE(sameScan(a, b));
  const auto nearest = [](const SimulatedScan& scan)
  {
    double range = 1e9;
    for (const SimulatedObject& object : scan.objects)
    {
      range = std::min(range, object.box.centre.norm());
    }
    return range;
  };
  EXPECT_NE(nearest(a), nearest(b));
}

TEST(Simulator, TheLoopTheOtherWayRound)
{
  for (const WorldKind world :
       {WorldKind::urban, WorldKind::campus, WorldKind::field, WorldKind::downtown})
  {
    SimulatorOptions options = small(world, 0);
    options.stops = false;
    const auto turnedLeft = [](const SimulatorOptions& o)
    {
      Simulator simulator(o, 2);
      double angle = 0;  // angle driven about the middle of the loop [rad]
      Eigen::Vector3d last = simulator.next().T_map_vehicle.translation();
      for (int i = 0; i < 20; ++i)
      {
        const Eigen::Vector3d now = simulator.next().T_map_vehicle.translation();
        angle += last.cross(now).z();
        last = now;
      }
      return angle > 0;
    };
    SimulatorOptions other = options;
    other.reverse = true;
    EXPECT_NE(turnedLeft(options), turnedLeft(other)) << toString(world);
  }
  SimulatorOptions highway = small(WorldKind::highway, 0);
  highway.reverse = true;
  EXPECT_THROW(Simulator(highway, 1), UserError);
}

TEST(Simulator, ALargestRangeBelowTheLeastIsRefused)
{
  SimulatorOptions options = small(WorldKind::field, 0);
  options.sensor = SensorKind::vlp16;  // from 0.4 m
  options.max_range = 0.5;
  EXPECT_NO_THROW(Simulator(options, 1));
  options.max_range = 0.4;
  EXPECT_THROW(Simulator(options, 1), UserError);
  options.max_range = 0.5;
  options.further_sensors = {{SensorKind::hdl32e, Pose::Identity()}};  // from 0.9 m
  EXPECT_THROW(Simulator(options, 1), UserError);
}

TEST(Simulator, StaticFlowEqualsTheEgoMotion)
{
  Simulator simulator(small(WorldKind::urban, 0.5));
  for (int i = 0; i < 10; ++i)
  {
    const SimulatedScan s = simulator.next();
    const Pose T_next_this = nextLidarPose(s).inverse() * lidarPose(s);
    ASSERT_EQ(s.flow.size(), s.scan.size());
    ASSERT_EQ(s.deskewed.size(), s.scan.size());
    ASSERT_EQ(s.label.size(), s.scan.size());
    for (std::size_t k = 0; k < s.scan.size(); ++k)
    {
      const std::uint32_t c = s.label[k] & 0xFFFFU;
      ASSERT_EQ(s.moving[k] != 0, c >= 252 && c <= 259);
      const Eigen::Vector3d p = s.deskewed[k].cast<double>();
      const Eigen::Vector3d residual = s.flow[k].cast<double>() - (T_next_this * p - p);
      if (s.moving[k] == 0 && (s.label[k] >> 16) < 30000)
      {
        ASSERT_LT(residual.norm(), 1e-3) << "label " << c;
      }
    }
  }
}

TEST(Simulator, PosesOfConsecutiveScansAgree)
{
  Simulator simulator(small(WorldKind::urban, 0.3));
  SimulatedScan before = simulator.next();
  for (int i = 0; i < 20; ++i)
  {
    const SimulatedScan s = simulator.next();
    EXPECT_LT((s.T_map_vehicle.matrix() - before.T_map_vehicle_next.matrix()).norm(), 1e-12);
    EXPECT_NEAR(s.scan.stamp - before.scan.stamp, 0.1, 1e-6);
    EXPECT_LT((s.T_map_vehicle.translation() - before.T_map_vehicle.translation()).norm(),
              0.1 * 16);
    before = s;
  }
}

// Without distortion bodies are static during a scan: points keep their position in the box, and
// flow moves them to the same position in the next scan's box.
TEST(Simulator, BoxesContainTheirPointsAndFlowFollowsThem)
{
  for (const auto world : {WorldKind::urban, WorldKind::campus, WorldKind::highway})
  {
    SimulatorOptions options = small(world, 0.7);
    options.motion_distortion = false;
    options.noise = false;
    Simulator simulator(options);
    SimulatedScan s = simulator.next();
    std::size_t checked = 0, moved = 0;
    for (int i = 0; i < 12; ++i)
    {
      SimulatedScan next = simulator.next();
      std::map<int, const SimulatedObject*> now, then;
      for (const auto& o : s.objects)
      {
        now[o.id] = &o;
      }
      for (const auto& o : next.objects)
      {
        then[o.id] = &o;
      }
      std::map<int, std::size_t> count;
      for (std::size_t k = 0; k < s.scan.size(); ++k)
      {
        const int id = static_cast<int>(s.label[k] >> 16);
        const auto object = now.find(id);
        if (id < 30000 || object == now.end())
        {
          continue;
        }
        ++count[id];
        const SimulatedObject& o = *object->second;
        const bool limbs =
            o.object_class == ObjectClass::pedestrian || o.object_class == ObjectClass::cyclist;
        const Eigen::Vector3d q = inBox(o.box, s.deskewed[k]);
        const Eigen::Vector3d half = 0.5 * o.box.size;
        const double slack =
            (limbs ? 0.2 : 0.06) + 0.05 * half.norm();  // boxes are upright, bodies are tilted
        EXPECT_LT((q.cwiseAbs() - half).maxCoeff(), slack)
            << toString(o.object_class) << " " << q.transpose() << " in " << half.transpose();
        EXPECT_EQ(s.moving[k] != 0, o.moving);
        const auto following = then.find(id);
        if (!limbs && following != then.end())
        {
          const Eigen::Vector3d before = inBody(lidarPose(s), o.box, s.deskewed[k]);
          const Eigen::Vector3d after =
              inBody(lidarPose(next), following->second->box, s.deskewed[k] + s.flow[k]);
          // The body is tilted with the ground.
          EXPECT_LT((after - before).norm(), 0.01 + 0.008 * before.norm());
          ++checked;
        }
      }
      for (const auto& o : s.objects)
      {
        moved += o.moving ? 1 : 0;
        EXPECT_EQ(o.points, count[o.id]);
        EXPECT_EQ(o.moving, o.velocity.norm() > options.moving_speed);
      }
      s = std::move(next);
    }
    EXPECT_GT(checked, 300U) << toString(world);
    EXPECT_GT(moved, 20U) << toString(world);
  }
}

/** Median distance from the points of a to their nearest neighbours in b, within a coarse grid. */
double medianDistance(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b)
{
  const auto key = [](const Eigen::Vector3f& p)
  {
    return (std::lround(std::floor(p.x())) + 512) | (std::lround(std::floor(p.y())) + 512) << 12 |
           (std::lround(std::floor(p.z())) + 512) << 24;
  };
  std::map<long, std::vector<Eigen::Vector3f>> cells;
  for (const auto& p : b)
  {
    cells[key(p)].push_back(p);
  }
  std::vector<float> distances;
  for (const auto& p : a)
  {
    float best = 1.5F;
    for (int dx = -1; dx <= 1; ++dx)
    {
      for (int dy = -1; dy <= 1; ++dy)
      {
        for (int dz = -1; dz <= 1; ++dz)
        {
          const auto cell =
              cells.find(key(p + Eigen::Vector3f(static_cast<float>(dx), static_cast<float>(dy),
                                                 static_cast<float>(dz))));
          if (cell != cells.end())
          {
            for (const auto& q : cell->second)
            {
              best = std::min(best, (p - q).norm());
            }
          }
        }
      }
    }
    distances.push_back(best);
  }
  return distances.empty() ? 1e9 : static_cast<double>(upperMedian(distances));
}

TEST(Simulator, FlowMovesPointsOntoTheNextScansSurface)
{
  SimulatorOptions options = small(WorldKind::highway, 0.6);
  options.columns = 2083;
  Simulator simulator(options);
  (void)simulator.next();
  SimulatedScan a = simulator.next();
  double with = 0, without = 0;
  for (int i = 0; i < 3; ++i)
  {
    const SimulatedScan b = simulator.next();
    std::vector<Eigen::Vector3f> here, flowed, there;
    for (std::size_t k = 0; k < a.scan.size(); ++k)
    {
      if (a.moving[k] != 0 && a.flow[k].norm() > 1 && a.scan.points[k].norm() < 40)
      {
        here.push_back(a.deskewed[k]);
        flowed.emplace_back(a.deskewed[k] + a.flow[k]);
      }
    }
    for (std::size_t k = 0; k < b.scan.size(); ++k)
    {
      if (b.moving[k] != 0)
      {
        there.push_back(b.deskewed[k]);
      }
    }
    ASSERT_GT(here.size(), 300U);
    with += medianDistance(flowed, there) / 3;
    without += medianDistance(here, there) / 3;
    a = b;
  }
  EXPECT_LT(with, 0.08);
  EXPECT_LT(with, 0.6 * without);
}

TEST(Simulator, DeskewingCompensatesEgoMotion)
{
  SimulatorOptions options = small(WorldKind::urban, 0);
  options.noise = false;
  options.columns = 2083;
  options.start_time = 10;
  options.stops = false;
  Simulator swept(options);
  options.motion_distortion = false;
  Simulator instant(options);
  const auto upright = [](std::uint32_t label)
  { return (label & 0xFFFFU) == 10 || (label & 0xFFFFU) == 71 || (label & 0xFFFFU) == 80; };
  const auto behind = [](const Eigen::Vector3f& p) { return p.x() < -3 && p.norm() < 30; };
  double raw_distance = 0, deskewed_distance = 0, travelled = 0;
  for (int i = 0; i < 4; ++i)
  {
    const SimulatedScan s = swept.next(), still = instant.next();
    ASSERT_EQ(s.T_map_vehicle.matrix(), still.T_map_vehicle.matrix());
    travelled += (s.T_map_vehicle_next.translation() - s.T_map_vehicle.translation()).norm() / 4;
    std::vector<Eigen::Vector3f> raw, deskewed, reference;
    for (std::size_t k = 0; k < s.scan.size(); ++k)
    {
      if (upright(s.label[k]) && behind(s.scan.points[k]))
      {
        raw.push_back(s.scan.points[k]);
        deskewed.push_back(s.deskewed[k]);
      }
    }
    for (std::size_t k = 0; k < still.scan.size(); ++k)
    {
      if (upright(still.label[k]))
      {
        reference.push_back(still.scan.points[k]);
      }
    }
    ASSERT_GT(raw.size(), 200U);
    raw_distance += medianDistance(raw, reference) / 4;
    deskewed_distance += medianDistance(deskewed, reference) / 4;
  }
  EXPECT_GT(travelled, 0.5);
  EXPECT_LT(deskewed_distance, 0.03);
  EXPECT_LT(deskewed_distance, 0.6 * raw_distance) << "travelled " << travelled;
}

TEST(Simulator, HasNoMovingPointsWithoutTraffic)
{
  for (const auto world :
       {WorldKind::urban, WorldKind::campus, WorldKind::highway, WorldKind::tunnel,
        WorldKind::field, WorldKind::downtown, WorldKind::indoor})
  {
    Simulator simulator(small(world, 0));
    const SimulatedScan s = simulator.next();
    EXPECT_TRUE(s.objects.empty()) << toString(world);
    EXPECT_EQ(std::count(s.moving.begin(), s.moving.end(), 1), 0) << toString(world);
    EXPECT_GT(s.scan.size(), 3000U) << toString(world);
  }
}

TEST(Simulator, ACityCentreHasShopsMotorcyclesAndMixedTraffic)
{
  SimulatorOptions options = small(WorldKind::downtown, 0.6);
  std::map<std::uint32_t, std::size_t> points;  // by class
  std::size_t moving = 0;
  for (const int seed : {5, 6, 7})
  {
    options.seed = seed;
    Simulator simulator(options, 2);
    for (int i = 0; i < 10; ++i)
    {
      const SimulatedScan s = simulator.next();
      ASSERT_GT(s.scan.size(), 10000U) << seed;
      for (std::size_t k = 0; k < s.scan.size(); ++k)
      {
        ++points[s.label[k] & 0xFFFFU];
        moving += s.moving[k];
      }
    }
  }
  constexpr std::uint32_t motorcycle = 15, building = 50, pole = 80, goods = 99;
  constexpr std::uint32_t moving_car = 252, moving_person = 254, moving_motorcyclist = 255,
                          moving_truck = 258;
  for (const std::uint32_t kind : {motorcycle, building, pole, goods, moving_car, moving_person,
                                   moving_motorcyclist, moving_truck})
  {
    EXPECT_GT(points[kind], 100U) << kind;
  }
  EXPECT_GT(moving, 5000U);
}

TEST(Simulator, GroundIsNotPlanar)
{
  for (const auto world : {WorldKind::urban, WorldKind::campus, WorldKind::highway,
                           WorldKind::field, WorldKind::downtown})
  {
    SimulatorOptions options = small(world, 0);
    options.noise = false;
    Simulator simulator(options);
    const SimulatedScan s = simulator.next();
    // Standard deviation of the ground's heights within 15 m about the best plane
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> ground;
    for (std::size_t k = 0; k < s.scan.size(); ++k)
    {
      const std::uint32_t c = s.label[k] & 0xFFFFU;
      if ((c == 40 || c == 48 || c == 72) && s.scan.points[k].norm() < 15)
      {
        const Eigen::Vector3d p = s.deskewed[k].cast<double>();
        const Eigen::Vector3d row(p.x(), p.y(), 1);
        a += row * row.transpose();
        b += row * p.z();
        ground.push_back(p);
      }
    }
    const Eigen::Vector3d plane = a.inverse() * b;
    double sum = 0;
    for (const auto& p : ground)
    {
      const double e = p.z() - plane.dot(Eigen::Vector3d(p.x(), p.y(), 1));
      sum += e * e;
    }
    EXPECT_GT(std::sqrt(sum / static_cast<double>(ground.size())), 0.015) << toString(world);
  }
}
}  // namespace
