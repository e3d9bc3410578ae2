// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/BoxFitting.h>
#include <dyslam/tracking/Detector.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

using namespace dyslam;
using Points = std::vector<Eigen::Vector3f>;

namespace
{
struct Scene
{
  Points points;
  std::vector<bool> moving;
  std::vector<float> probability;
  std::mt19937 generator{4};

  void add(const Eigen::Vector3d& p, float moving_probability)
  {
    points.push_back(p.cast<float>());
    moving.push_back(moving_probability > 0.5F);
    probability.push_back(moving_probability);
  }
  /** Static flat ground at height `z` [m]. */
  void addGround(double z)
  {
    for (double x = -30; x <= 30; x += 0.5)
    {
      for (double y = -30; y <= 30; y += 0.5)
      {
        add({x, y, z}, 0);
      }
    }
  }
  /** Points on the sides of a box that face the origin. */
  void addVisibleSides(const Box& box, int count)
  {
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    std::normal_distribution<double> noise(0, 0.01);
    const Eigen::Rotation2Dd turn(box.yaw);
    const Eigen::Vector2d to_sensor = turn.inverse() * (-box.centre.head<2>());
    for (int i = 0; i < count; ++i)
    {
      Eigen::Vector2d local(unit(generator) * box.size.x(), unit(generator) * box.size.y());
      const bool on_end = i % 3 == 0 && std::abs(to_sensor.x()) > 0.5 * box.size.x();
      if (on_end)
      {
        local.x() = std::copysign(0.5 * box.size.x(), to_sensor.x());
      }
      else
      {
        local.y() = std::copysign(0.5 * box.size.y(), to_sensor.y());
      }
      const Eigen::Vector2d flat = turn * local + box.centre.head<2>();
      add({flat.x() + noise(generator), flat.y() + noise(generator),
           box.centre.z() + unit(generator) * box.size.z()},
          0.9F);
    }
  }
};

Box makeBox(double x, double y, double z, double l, double w, double h, double yaw)
{
  Box box;
  box.centre = {x, y, z};
  box.size = {l, w, h};
  box.yaw = yaw;
  return box;
}
}  // namespace

TEST(Detector, detectsCarPedestrianAndCyclist)
{
  Scene scene;
  scene.addGround(-1.7);
  const Box car = makeBox(12, 5, -0.8, 4.3, 1.8, 1.5, 0.5);
  const Box person = makeBox(8, -4, -0.75, 0.6, 0.5, 1.7, 0);
  const Box cyclist = makeBox(15, -6, -0.75, 1.8, 0.6, 1.7, 1.2);
  scene.addVisibleSides(car, 600);
  scene.addVisibleSides(person, 120);
  scene.addVisibleSides(cyclist, 200);
  Detector detector;
  const std::vector<Detection> found =
      detector.detect(scene.points, scene.moving, scene.probability);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].object_class, ObjectClass::car);
  EXPECT_EQ(found[1].object_class, ObjectClass::pedestrian);
  EXPECT_EQ(found[2].object_class, ObjectClass::cyclist);
  EXPECT_GT(boxOverlap(found[0].box, car).ground_iou, 0.85);
  EXPECT_NEAR(std::remainder(found[0].box.yaw - 0.5, M_PI), 0, 0.05);
  EXPECT_LT((found[1].box.centre - person.centre).head<2>().norm(), 0.3);
  EXPECT_GT(found[1].covariance(3, 3), found[0].covariance(3, 3));
  for (const Detection& detection : found)
  {
    EXPECT_EQ(Eigen::LLT<Eigen::Matrix4d>(detection.covariance).info(), Eigen::Success);
    for (const auto i : detection.points)
    {
      EXPECT_TRUE(scene.moving[i]);
    }
  }
}

/** Ground points marked as moving must not link the objects above them. */
TEST(Detector, movingGroundDoesNotLinkTwoPedestrians)
{
  Scene scene;
  scene.addGround(-1.7);
  scene.addVisibleSides(makeBox(10, 0, -0.75, 0.6, 0.5, 1.7, 0), 100);
  scene.addVisibleSides(makeBox(10, 2, -0.75, 0.6, 0.5, 1.7, 0), 100);
  for (double y = 0; y <= 2; y += 0.05)
  {
    scene.add({10, y, -1.68}, 0.9F);
  }
  EXPECT_EQ(Detector().detect(scene.points, scene.moving, scene.probability).size(), 2u);
}

/** Vehicles may be long but are narrow: trams and road trains are detected, buildings are not. */
TEST(Detector, longNarrowClustersAreTrucks)
{
  const auto detect = [](double length, double width)
  {
    Scene scene;
    const double x = 4 + 0.5 * length;  // its end and one side are visible
    scene.addVisibleSides(makeBox(x, 8 + 0.5 * width, 1, length, width, 3, 0.1), 9000);
    scene.addGround(-1.7);
    return Detector().detect(scene.points, scene.moving, scene.probability);
  };
  const auto tram = detect(35, 2.6);
  ASSERT_EQ(tram.size(), 1u);
  EXPECT_EQ(tram[0].object_class, ObjectClass::truck);
  EXPECT_NEAR(tram[0].box.size.x(), 35, 0.5);
  EXPECT_NEAR(std::remainder(tram[0].box.yaw - 0.1, M_PI), 0, 0.03);
  EXPECT_TRUE(detect(55, 2.6).empty());
  EXPECT_TRUE(detect(25, 6).empty());
  EXPECT_EQ(detect(18, 6).size(), 1u);
}

/** Points of a distant car have wide gaps but still form one cluster. */
TEST(Detector, clusteringAdaptsToRange)
{
  Scene scene;
  for (double y = -1; y <= 1; y += 0.7)
  {
    for (double z = -1.5; z <= 0; z += 0.3)
    {
      scene.add({60, y, z}, 0.9F);
      scene.add({8, y, z}, 0.9F);
    }
  }
  scene.addGround(-1.9);
  const auto found = Detector().detect(scene.points, scene.moving, scene.probability);
  int far = 0;
  int near = 0;
  for (const Detection& detection : found)
  {
    (detection.box.centre.x() > 30 ? far : near) += 1;
  }
  EXPECT_EQ(far, 1);
  EXPECT_EQ(near, 0);  // single columns, thinner than any object: below min_points each
}

/** A row of moving points along y, `length` long at a distance of 20 m and a height of 0.5 m under
 * the lidar, and static returns of the ring `gap` below it, on the ground before the row. */
Scene rowOfOneRing(double length, double gap)
{
  constexpr double distance = 20;
  constexpr double height = -0.5;
  Scene scene;
  const double nearer = 0.7;  // the lower ring hits the ground at this part of the distance
  for (double y = -0.5 * length; y <= 0.5 * length; y += 0.1)
  {
    scene.add({distance, y, height}, 0.9F);
    scene.add({nearer * distance, nearer * y, nearer * (height - gap)}, 0);
  }
  return scene;
}

TEST(Detector, withHindsightARowOfOneRingIsAnObjectUnlessARayPassesCloseBelow)
{
  const auto count = [](const Scene& scene, MovingLabels labels)
  { return Detector({}, labels).detect(scene.points, scene.moving, scene.probability).size(); };
  const Scene sparse = rowOfOneRing(4, 0.8);
  EXPECT_EQ(count(sparse, MovingLabels::hindsight), 1U);
  EXPECT_EQ(count(sparse, MovingLabels::causal), 0U) << "lower than min_height";
  EXPECT_EQ(count(rowOfOneRing(4, 0.6), MovingLabels::hindsight), 0U) << "a ray passes below";
  EXPECT_EQ(count(rowOfOneRing(7, 0.8), MovingLabels::hindsight), 0U) << "a wall";
}

TEST(Detector, withHindsightDistantPointsNearTheGroundCount)
{
  const auto lowest = [](double x, MovingLabels labels)
  {
    Scene scene;
    scene.addGround(-1.7);
    scene.addVisibleSides(makeBox(x, 5, -1.65, 0.6, 0.5, 0.1, 0), 60);  // below ground_clearance
    scene.addVisibleSides(makeBox(x, 5, -0.8, 0.6, 0.5, 1.6, 0), 60);
    const auto found = Detector({}, labels).detect(scene.points, scene.moving, scene.probability);
    EXPECT_EQ(found.size(), 1U);
    return found.empty() ? 0 : found[0].box.centre.z() - 0.5 * found[0].box.size.z();
  };
  EXPECT_LT(lowest(14, MovingLabels::hindsight), -1.6);
  EXPECT_GT(lowest(14, MovingLabels::causal), -1.5);
  EXPECT_GT(lowest(9, MovingLabels::hindsight), -1.5);
}

/** Persons abreast at a distance of 8 m, at the given y [m], between whom rays reach a wall. */
std::vector<Detection> detectPersons(const std::vector<double>& persons, double wall)
{
  Scene scene;
  for (double y = -6; y <= 6; y += 0.05)
  {
    for (double z = -1.4; z <= 0.8; z += 0.1)
    {
      // Where rays end at the persons, none reaches the wall.
      const double at_persons = 8 / wall * y;
      if (std::none_of(persons.begin(), persons.end(),
                       [&](double person) { return std::abs(at_persons - person) < 0.3; }))
      {
        scene.add({wall, y, z}, 0);
      }
    }
  }
  for (const double y : persons)
  {
    scene.addVisibleSides(makeBox(8, y, -0.75, 0.4, 0.5, 1.7, 0), 150);
  }
  const Eigen::Vector3f lidar(0, 0, -0.9F);  // 0.7 m above the floor
  return Detector().detect(scene.points, scene.moving, scene.probability, lidar);
}

/** Groups of the size of a car and of a cyclist. */
TEST(Detector, aGroupOfPersonsThatLetsRaysThroughIsSplit)
{
  const std::vector<std::pair<std::vector<double>, ObjectClass>> groups{
      {{-0.93, 0, 0.93}, ObjectClass::car}, {{-0.45, 0.45}, ObjectClass::cyclist}};
  for (const auto& [persons, class_of_all] : groups)
  {
    const std::vector<Detection> group = detectPersons(persons, 14);
    ASSERT_EQ(group.size(), persons.size());
    for (const Detection& detection : group)
    {
      EXPECT_EQ(detection.object_class, ObjectClass::pedestrian);
      EXPECT_LT(detection.box.size.x(), 0.8);
    }
    // Without a return from beyond it may be one object, of which the points between are missing.
    const std::vector<Detection> one = detectPersons(persons, 8.2);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_EQ(one[0].object_class, class_of_all);
  }
}

/** Rays through the windows of a car, above the middle of its height, do not split it. */
TEST(Detector, raysThroughWindowsDoNotSplitACar)
{
  Scene scene;
  const Box car = makeBox(10, 3, -0.95, 4.3, 1.8, 1.5, 0);
  for (const double x : {8.2, 9.1, 10.0, 10.9, 11.8})  // reflecting parts, 0.4 m apart
  {
    scene.addVisibleSides(makeBox(x, 2.35, -0.95, 0.5, 0.5, 1.5, 0), 150);
  }
  for (double x = 15; x <= 24; x += 0.05)
  {
    for (double z = -0.9; z <= 0; z += 0.05)
    {
      scene.add({x, 5, z}, 0);
    }
  }
  const std::vector<Detection> found =
      Detector().detect(scene.points, scene.moving, scene.probability);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].box.size.x(), car.size.x(), 0.3);
}

TEST(Detector, handlesEmptySinglePointAndNaN)
{
  Detector detector;
  EXPECT_TRUE(detector.detect({}, {}, {}).empty());
  EXPECT_TRUE(detector.detect({{1, 2, 3}}, {true}, {1.0F}).empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Points bad(50, Eigen::Vector3f(nan, 1, 1));
  EXPECT_TRUE(
      detector.detect(bad, std::vector<bool>(50, true), std::vector<float>(50, 1.0F)).empty());
  Frame frame;
  frame.cloud.points.assign(100, {5, 5, 0});
  frame.detections.resize(3);
  detector.detect(frame);  // no probabilities
  EXPECT_TRUE(frame.detections.empty());
}

TEST(Detector, lShapeFitRecoversTheHeading)
{
  for (double yaw = -1.5; yaw < 1.6; yaw += 0.23)
  {
    Scene scene;
    scene.addVisibleSides(makeBox(10, 6, 0, 4.5, 1.8, 1.5, yaw), 400);
    const Box box = fitLShape(scene.points, 0.02);
    EXPECT_NEAR(std::remainder(box.yaw - yaw, M_PI), 0, 0.06) << yaw;
    EXPECT_NEAR(box.size.x(), 4.5, 0.25) << yaw;
  }
}

TEST(Detector, completeBoxKeepsTheVisibleSides)
{
  // Only the rear of a car ahead is visible: the rest lies beyond.
  const Box rear = makeBox(10, 0, 0, 0.3, 1.8, 1.5, 0);
  const Box full = completeBox(rear, {4.3, 1.8, 1.5});
  EXPECT_NEAR(full.centre.x() - 0.5 * full.size.x(), 9.85, 1e-9);
  EXPECT_NEAR(full.centre.y(), 0, 1e-9);
  EXPECT_NEAR(full.size.x(), 4.3, 1e-12);
  // Of a car behind, only the front is visible.
  const Box behind = completeBox(makeBox(-10, 0, 0, 0.3, 1.8, 1.5, 0), {4.3, 1.8, 1.5});
  EXPECT_NEAR(behind.centre.x() + 0.5 * behind.size.x(), -9.85, 1e-9);
}

TEST(Detector, optionsRoundTripThroughText)
{
  DetectorOptions options;
  options.cluster_gap = 0.37;
  Config config;
  save(options, config, "detector");
  DetectorOptions loaded;
  load(loaded, Config::fromText(config.toIni(), "test"), "detector");
  EXPECT_DOUBLE_EQ(loaded.cluster_gap, 0.37);
  options.min_points = 0;
  EXPECT_ANY_THROW(Detector{options});
}

TEST(Detector, theGapAtRangeZeroIsWithinItsLimit)
{
  DetectorOptions options;
  options.cluster_gap = options.max_cluster_gap;
  EXPECT_NO_THROW(Detector{options});
  options.cluster_gap += 0.1;
  EXPECT_THROW(Detector{options}, UserError);
}
