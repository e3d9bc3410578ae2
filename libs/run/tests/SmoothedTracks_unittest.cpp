// SPDX-License-Identifier: BSD-3-Clause
#include "../src/results/SmoothedTracks.h"

#include <dyslam/base/Angle.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr double speed = 6;     // of the vehicle, along +x [m/s]
constexpr double length = 4.5;  // [m]

/** A vehicle that drives past the sensor at the origin and comes into view from its rear on: its
 * visible part grows for a second. Its centre is at `x(t) = 5 m + speed t`.
 * \param clock_step by which the clock of the time stamps is set in the middle [s] */
RunHistory vehicleThatComesIntoView(int scans, Trajectory& trajectory, double clock_step = 0)
{
  RunHistory history;
  for (int i = 0; i < scans; ++i)
  {
    const double time = 0.1 * i;
    Frame frame;
    frame.index = static_cast<std::size_t>(3 + i);
    frame.clock_offset = 2 * i >= scans ? clock_step : 0;
    frame.scan.stamp = time + frame.clock_offset;
    TrackedObject object;
    object.id = 7;
    object.object_class = ObjectClass::car;
    object.reported = object.observed = object.dynamic = true;
    object.box.size = {std::min(length, 0.5 + 4 * time), 1.8, 1.5};
    object.box.centre = {5 + speed * time - 0.5 * (length - object.box.size.x()), 3, 0.8};
    object.velocity = {speed, 0, 0};
    frame.objects.push_back(object);
    history.addScan(frame);
    history.addObjects(frame.index, frame.objects, TrackLife::reported);
    trajectory.push_back(frame.scan.stamp, Pose::Identity());
  }
  return history;
}

TEST(SmoothedTracks, VehiclesHaveTheirWholeSizeFromTheFirstScanOn)
{
  Trajectory trajectory;
  const RunHistory history = vehicleThatComesIntoView(40, trajectory);
  const auto objects = smoothTracks(history, trajectory, {}, true).objects;
  ASSERT_EQ(objects.size(), 40U);
  for (std::size_t i = 0; i < objects.size(); ++i)
  {
    const SmoothedObject& object = objects[i];
    EXPECT_EQ(object.id, 7);
    EXPECT_EQ(object.scan, 3 + i);
    EXPECT_TRUE(object.moving);
    ASSERT_TRUE(object.size);
    EXPECT_NEAR(object.size->x(), length, 1e-9);
    EXPECT_NEAR(object.T_map_object.translation().x(), 5 + speed * object.stamp, 0.05) << i;
    EXPECT_NEAR(object.velocity.x(), speed, 0.1) << i;
  }
  // Boxes of a detector are those of whole objects.
  const auto given = smoothTracks(history, trajectory, {}, false).objects;
  EXPECT_NEAR(given.front().size->x(), 0.5, 1e-9);
  EXPECT_GT(given.front().velocity.x(), speed + 1);
}

TEST(SmoothedTracks, VelocitiesDoNotDependOnStepsOfTheClock)
{
  for (const double step : {-30.0, 7.0})
  {
    Trajectory trajectory;
    const RunHistory history = vehicleThatComesIntoView(40, trajectory, step);
    const auto objects = smoothTracks(history, trajectory, {}, true).objects;
    ASSERT_EQ(objects.size(), 40U);
    for (std::size_t i = 0; i < objects.size(); ++i)
    {
      EXPECT_EQ(objects[i].stamp, trajectory[i].stamp);
      EXPECT_NEAR(objects[i].velocity.x(), speed, 0.1) << i;
      EXPECT_TRUE(objects[i].moving);
    }
  }
}

TEST(SmoothedTracks, PositionsAreInTheMapFrame)
{
  Trajectory trajectory;
  const RunHistory history = vehicleThatComesIntoView(20, trajectory);
  const Pose T_map_odom(Eigen::Translation3d(10, -20, 1) *
                        Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  Trajectory moved;
  for (const auto& [stamp, pose] : trajectory)
  {
    moved.push_back(stamp, T_map_odom * pose);
  }
  const auto objects = smoothTracks(history, trajectory, {}, true).objects;
  const auto in_map = smoothTracks(history, moved, {}, true).objects;
  ASSERT_EQ(objects.size(), in_map.size());
  for (std::size_t i = 0; i < objects.size(); ++i)
  {
    EXPECT_TRUE(in_map[i].T_map_object.isApprox(T_map_odom * objects[i].T_map_object, 1e-6));
    EXPECT_TRUE(in_map[i].velocity.isApprox(T_map_odom.linear() * objects[i].velocity, 1e-6));
  }
}

/** A vehicle that drives along +y, 10 m in front of the sensor, and of which the rear alone is
 * seen, as a box with its longer side across. The tracker reports it from the tenth scan on and
 * does not know its heading. */
RunHistory rearOfCar(Trajectory& trajectory)
{
  RunHistory history;
  for (int i = 0; i < 30; ++i)
  {
    Frame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.scan.stamp = 0.1 * i;
    TrackedObject object;
    object.id = 2;
    object.object_class = ObjectClass::car;
    object.observed = true;
    object.reported = object.dynamic = i >= 10;
    object.box.size = {1.8, 0.4, 1.5};
    object.box.centre = {1, 10 + speed * frame.scan.stamp, 0.8};
    object.box.yaw = i < 10 ? M_PI : 0;
    history.addScan(frame);
    history.addObjects(frame.index, {object}, TrackLife::whole);
    trajectory.push_back(frame.scan.stamp, Pose::Identity());
  }
  return history;
}

TEST(SmoothedTracks, VehiclesHeadWhereTheyDriveAndAreAsLongAsACar)
{
  Trajectory trajectory;
  const RunHistory history = rearOfCar(trajectory);
  const auto objects = smoothTracks(history, trajectory, {}, true).objects;
  ASSERT_EQ(objects.size(), 30U);
  for (const SmoothedObject& object : objects)
  {
    EXPECT_NEAR(yawPitchRoll(object.T_map_object).x(), M_PI / 2, 0.01);
    ASSERT_TRUE(object.size);
    EXPECT_TRUE(object.size->isApprox(Eigen::Vector3d(4, 1.8, 1.5), 1e-9)) << *object.size;
    // The rear stays in place: at y = 10 m - 0.2 m at the beginning.
    EXPECT_NEAR(object.T_map_object.translation().y(), 11.8 + speed * object.stamp, 0.02);
    EXPECT_TRUE(object.moving) << object.scan;
  }
}

TEST(SmoothedTracks, BoxesOfADetectorAreNotEnlarged)
{
  Trajectory trajectory;
  const RunHistory history = rearOfCar(trajectory);
  const auto objects = smoothTracks(history, trajectory, {}, false).objects;
  ASSERT_EQ(objects.size(), 30U);
  EXPECT_NEAR(objects.back().size->x(), 1.8, 1e-9);
  EXPECT_NEAR(std::abs(yawPitchRoll(objects.back().T_map_object).x()), 0, 1e-9);
}

/** An object of 20 scans that moves along +x with `object_speed` [m/s], smoothed. */
std::vector<SmoothedObject> smoothedObject(ObjectClass object_class,
                                           const Eigen::Vector3d& size,
                                           double object_speed)
{
  Trajectory trajectory;
  RunHistory history;
  for (int i = 0; i < 20; ++i)
  {
    Frame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.scan.stamp = 0.1 * i;
    TrackedObject object;
    object.id = 3;
    object.object_class = object_class;
    object.observed = object.reported = object.dynamic = true;
    object.box.size = size;
    object.box.centre = {5 + object_speed * frame.scan.stamp, -3, 0.9};
    history.addScan(frame);
    history.addObjects(frame.index, {object}, TrackLife::whole);
    trajectory.push_back(frame.scan.stamp, Pose::Identity());
  }
  return smoothTracks(history, trajectory, {}, true).objects;
}

/** Headings of an object that stands for 20 scans and then moves along +y, with boxes whose
 * headings change between `yaw` and the opposite. */
std::vector<double> headingsOf(ObjectClass object_class,
                               const Eigen::Vector3d& size,
                               double yaw,
                               double object_speed)
{
  Trajectory trajectory;
  RunHistory history;
  for (int i = 0; i < 60; ++i)
  {
    Frame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.scan.stamp = 0.1 * i;
    TrackedObject object;
    object.id = 3;
    object.object_class = object_class;
    object.observed = object.reported = object.dynamic = true;
    object.box.size = size;
    object.box.yaw = i % 3 == 0 ? yaw : wrapAngle(yaw + M_PI);
    object.box.centre = {5, object_speed * 0.1 * std::max(0, i - 20), 0.9};
    history.addScan(frame);
    history.addObjects(frame.index, {object}, TrackLife::whole);
    trajectory.push_back(frame.scan.stamp, Pose::Identity());
  }
  std::vector<double> headings;
  for (const SmoothedObject& object : smoothTracks(history, trajectory, {}, true).objects)
  {
    headings.push_back(yawPitchRoll(object.T_map_object).x());
    EXPECT_TRUE(object.size);
    EXPECT_NEAR(object.size->prod(), size.prod(), 1e-6) << "the box is turned, not enlarged";
  }
  return headings;
}

TEST(SmoothedTracks, PeopleHeadWhereTheyWalkAlsoWhileTheyStand)
{
  for (const double heading :
       headingsOf(ObjectClass::pedestrian, {0.9, 0.7, 1.7}, 0.3, 1.3))  // the box is across
  {
    EXPECT_NEAR(heading, M_PI / 2, 0.02);
  }
}

TEST(SmoothedTracks, SlowVehiclesKeepTheirFrontAndMoveForward)
{
  for (const double yaw : {M_PI / 2 + 0.1, -M_PI / 2 + 0.1})
  {
    for (const double heading : headingsOf(ObjectClass::car, {4.5, 1.9, 1.6}, yaw, 1.2))
    {
      EXPECT_NEAR(heading, M_PI / 2 + 0.1, 0.02);
    }
  }
}

TEST(SmoothedTracks, FastPeopleAreCyclistsAndHaveTheirSize)
{
  const auto objects = smoothedObject(ObjectClass::pedestrian, {0.8, 0.4, 1.7}, speed);
  ASSERT_EQ(objects.size(), 20U);
  for (const SmoothedObject& object : objects)
  {
    EXPECT_EQ(object.object_class, ObjectClass::cyclist);
    EXPECT_TRUE(object.size->isApprox(Eigen::Vector3d(1.6, 0.6, 1.7), 1e-9));
    EXPECT_NEAR(object.T_map_object.translation().x(), 5 + speed * object.stamp, 0.01);
  }
}

TEST(SmoothedTracks, SlowCyclistsAndSmallPartsAreOfPedestrians)
{
  const Eigen::Vector3d as_cyclist(1.6, 0.7, 1.7);
  const Eigen::Vector3d part(0.4, 0.2, 0.6);
  const Eigen::Vector3d machine(1.6, 1.1, 0.7);
  const auto classOf = [](ObjectClass object_class, const Eigen::Vector3d& size, double its_speed)
  { return smoothedObject(object_class, size, its_speed).front().object_class; };
  EXPECT_EQ(classOf(ObjectClass::cyclist, as_cyclist, 1.3), ObjectClass::pedestrian);
  EXPECT_EQ(classOf(ObjectClass::cyclist, as_cyclist, 3), ObjectClass::cyclist);
  EXPECT_EQ(classOf(ObjectClass::unknown, part, 1.3), ObjectClass::pedestrian);
  EXPECT_EQ(classOf(ObjectClass::unknown, part, 6), ObjectClass::unknown);
  EXPECT_EQ(classOf(ObjectClass::unknown, machine, 1.3), ObjectClass::unknown);
}

TEST(SmoothedTracks, TracksThatAlternateAreMerged)
{
  // One vehicle; every third scan observes the second track instead of the first one.
  Trajectory trajectory;
  RunHistory history;
  for (int i = 0; i < 30; ++i)
  {
    Frame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.scan.stamp = 0.1 * i;
    for (const int id : {4, 9})
    {
      TrackedObject object;
      object.id = id;
      object.object_class = ObjectClass::car;
      object.observed = (i % 3 == 2) == (id == 9);
      object.reported = object.dynamic = true;
      object.box.size = {4.5, 1.8, 1.5};
      object.box.centre = {5 + speed * frame.scan.stamp + (object.observed ? 0 : 0.7), -3, 0.9};
      frame.objects.push_back(object);
    }
    history.addScan(frame);
    history.addObjects(frame.index, frame.objects, TrackLife::whole);
    trajectory.push_back(frame.scan.stamp, Pose::Identity());
  }
  const SmoothedTracks tracks = smoothTracks(history, trajectory, {}, true);
  EXPECT_EQ(tracks.merged, (std::map<int, int>{{9, 4}}));
  ASSERT_EQ(tracks.objects.size(), 30U);
  for (const SmoothedObject& object : tracks.objects)
  {
    EXPECT_EQ(object.id, 4);
    EXPECT_NEAR(object.T_map_object.translation().x(), 5 + speed * object.stamp, 0.01);
  }
  TrackSmoothingOptions apart;
  apart.merge_overlap = 1;
  EXPECT_GT(smoothTracks(history, trajectory, apart, true).objects.size(), 50U);
}

TEST(SmoothedTracks, NoneWithoutWindow)
{
  Trajectory trajectory;
  const RunHistory history = vehicleThatComesIntoView(5, trajectory);
  TrackSmoothingOptions options;
  options.window = 0;
  EXPECT_TRUE(smoothTracks(history, trajectory, options, true).objects.empty());
}
}  // namespace
}  // namespace dyslam
