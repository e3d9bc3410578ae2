// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/sim/ClipGenerator.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

namespace
{
using namespace dyslam;
using namespace dyslam::sim;

SimulatorOptions small(WorldKind world, double traffic)
{
  SimulatorOptions o;
  o.world = world;
  o.sensor = SensorKind::hdl64e;
  o.columns = 400;
  o.traffic = traffic;
  o.loop_length = 300;
  o.seed = 5;
  return o;
}

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool sameScan(const SimulatedScan& a, const SimulatedScan& b)
{
  return sameBytes(a.scan.points, b.scan.points) && sameBytes(a.scan.intensity, b.scan.intensity) &&
         sameBytes(a.scan.time, b.scan.time) && sameBytes(a.scan.ring, b.scan.ring) &&
         sameBytes(a.deskewed, b.deskewed) && sameBytes(a.flow, b.flow) &&
         sameBytes(a.label, b.label) && sameBytes(a.moving, b.moving) &&
         a.T_map_vehicle.matrix() == b.T_map_vehicle.matrix() &&
         a.objects.size() == b.objects.size();
}

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
  return Eigen::AngleAxisd(-box.yaw, Eigen::Vector3d::UnitZ()) * (p.cast<double>() - box.center);
}

/** Position of a point in its body, computed in the map so that the sensor's tilt has no effect. */
Eigen::Vector3d inBody(const Pose& T_map_lidar, const Box& box, const Eigen::Vector3f& p)
{
  const Eigen::Vector3d heading =
      T_map_lidar.linear() * Eigen::Vector3d(std::cos(box.yaw), std::sin(box.yaw), 0);
  return Eigen::AngleAxisd(-std::atan2(heading.y(), heading.x()), Eigen::Vector3d::UnitZ()) *
         (T_map_lidar.linear() * (p.cast<double>() - box.center));
}

TEST(Simulator, EqualSeedsGiveEqualBytesOnAnyNumberOfThreads)
{
  for (const auto world : {WorldKind::urban, WorldKind::campus, WorldKind::highway})
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
      range = std::min(range, object.box.center.norm());
    }
    return range;
  };
  EXPECT_NE(nearest(a), nearest(b));
}

TEST(Simulator, TheLoopTheOtherWayRound)
{
  for (const WorldKind world : {WorldKind::urban, WorldKind::campus, WorldKind::field})
  {
    SimulatorOptions options = small(world, 0);
    options.stops = false;
    const auto turnedLeft = [](const SimulatorOptions& o)
    {
      Simulator simulator(o, 2);
      double angle = 0;  // about the middle of the loop
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
  std::nth_element(distances.begin(),
                   distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  return distances.empty() ? 1e9 : static_cast<double>(distances[distances.size() / 2]);
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
  for (const auto world : {WorldKind::urban, WorldKind::campus, WorldKind::highway,
                           WorldKind::tunnel, WorldKind::field})
  {
    Simulator simulator(small(world, 0));
    const SimulatedScan s = simulator.next();
    EXPECT_TRUE(s.objects.empty()) << toString(world);
    EXPECT_EQ(std::count(s.moving.begin(), s.moving.end(), 1), 0) << toString(world);
    EXPECT_GT(s.scan.size(), 3000U) << toString(world);
  }
}

TEST(Simulator, GroundIsNotPlanar)
{
  for (const auto world :
       {WorldKind::urban, WorldKind::campus, WorldKind::highway, WorldKind::field})
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
      if (std::abs(axis.dot((a.center - b.center).head<2>())) > extent(a, axis) + extent(b, axis))
      {
        return false;
      }
    }
  }
  return true;
}

TEST(Traffic, VehiclesDoNotCollide)
{
  for (const auto world : {WorldKind::urban, WorldKind::highway})
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
                (s.objects[k].box.center - s.objects[l].box.center).norm() < 20)
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

TEST(Ego, ClosesItsLoop)
{
  for (const auto world : {WorldKind::urban, WorldKind::campus, WorldKind::field})
  {
    SimulatorOptions options = small(world, 0);
    options.columns = 8;
    options.stops = false;
    options.ego_speed = world == WorldKind::urban ? 12 : 4;
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

/** Standard deviation, and correlation with the same `lag` samples later. */
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

// OXTS of the KITTI tracking data, 17 sequences above 5 m/s: 0.006 to 0.026 rad/s, mostly 0.012 to
// 0.020; correlation after 0.1 s 0.47 to 0.82.
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

TEST(ClipGenerator, ClipsDoNotDependOnTheirOrder)
{
  ClipOptions options;
  options.simulator.columns = 200;
  options.simulator.loop_length = 300;
  options.scans = 2;
  options.clips_per_world = 2;
  const ClipGenerator a(options), b(options);
  const auto a0 = a.clip(0), a1 = a.clip(1), a5 = a.clip(5);
  const auto b5 = b.clip(5), b1 = b.clip(1), b0 = b.clip(0);
  ASSERT_EQ(a0.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
  {
    EXPECT_TRUE(sameScan(a0[i], b0[i]));
    EXPECT_TRUE(sameScan(a1[i], b1[i]));
    EXPECT_TRUE(sameScan(a5[i], b5[i]));
  }
  EXPECT_FALSE(sameScan(a0[0], a1[0]));
  EXPECT_EQ(a.clipOptions(0).seed, a.clipOptions(1).seed);
}

TEST(ClipGenerator, WorldsHaveSeedsWithinTheirBounds)
{
  ClipOptions options;
  options.clips_per_world = 1;
  options.least_seed = 500000000;
  options.most_seed = 500000002;
  const ClipGenerator generator(options);
  std::set<int> seeds;
  for (std::uint64_t i = 0; i < 60; ++i)
  {
    seeds.insert(generator.clipOptions(i).seed);
  }
  EXPECT_EQ(seeds, (std::set<int>{500000000, 500000001, 500000002}));
}
}  // namespace
