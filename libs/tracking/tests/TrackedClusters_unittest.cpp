// SPDX-License-Identifier: BSD-3-Clause
// Tracks of clusters of points, and the first observations of a track.
#include <dyslam/base/Angle.h>
#include <dyslam/tracking/BoxFitting.h>
#include <dyslam/tracking/Tracker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "TestDetections.h"

using namespace dyslam;

namespace
{
using test::carAt;
using test::clusterAt;
using test::dt;
}  // namespace

/** Static clusters (occlusion boundaries, leaves) are never reported; moving ones are reported
 * soon. Boxes read from a file need not move. */
TEST(TrackedClusters, clustersMustMoveToBeReported)
{
  std::mt19937 generator(31);
  std::normal_distribution<double> noise(0, 0.1);
  Tracker tracker;
  int first_reported = -1;
  for (int scan = 0; scan < 60; ++scan)
  {
    const auto objects = tracker.update(
        dt * scan,
        {clusterAt({10 + noise(generator), 5 + noise(generator)}),
         clusterAt({-10 + 0.5 * scan + 0.3 * noise(generator), -5 + 0.3 * noise(generator)}),
         carAt({0, 20})},
        Pose::Identity());
    ASSERT_EQ(objects.size(), 3u);
    EXPECT_FALSE(objects[0].reported) << scan;
    EXPECT_EQ(objects[2].reported, scan >= 2);
    if (objects[1].reported && first_reported < 0)
    {
      first_reported = scan;
    }
  }
  EXPECT_GE(first_reported, 3);
  EXPECT_LE(first_reported, 8);
}

/** Whether slow motion is significant depends on the time that it lasts, at any rate of scans. */
TEST(TrackedClusters, slowPeopleAreReportedAtAnyRate)
{
  constexpr double speed = 0.6;  // [m/s]
  for (const TrackMotion motion :
       {TrackMotion::adaptive, TrackMotion::polynomial, TrackMotion::kalman})
  {
    for (const double interval : {0.05, 0.1, 0.2})
    {
      TrackerOptions options;
      options.motion = motion;
      Tracker tracker(options);
      std::vector<TrackedObject> objects;
      for (int scan = 0; scan * interval < 3; ++scan)
      {
        Detection person = clusterAt({5 + speed * interval * scan, -6});
        person.box.size = {0.6, 0.5, 1.7};
        person.object_class = ObjectClass::pedestrian;
        objects = tracker.update(interval * scan, {person}, Pose::Identity());
        ASSERT_EQ(objects.size(), 1u) << interval;
      }
      EXPECT_TRUE(objects[0].reported) << static_cast<int>(motion) << " " << interval;
    }
  }
}

/** Of a tram that passes by, one side is visible. It is a vehicle, and no strip. */
TEST(TrackedClusters, sidesOfLongVehiclesAreReported)
{
  Tracker tracker;
  std::vector<TrackedObject> objects;
  for (int scan = 0; scan < 20; ++scan)
  {
    Detection tram = clusterAt({-40 + 1.0 * scan, 8});
    tram.box.size = {30, 0.1, 2.8};
    tram.object_class = ObjectClass::truck;
    objects = tracker.update(dt * scan, {tram}, Pose::Identity());
    ASSERT_EQ(objects.size(), 1u);
  }
  EXPECT_TRUE(objects[0].reported);
  EXPECT_EQ(objects[0].object_class, ObjectClass::truck);
  EXPECT_GT(objects[0].box.size.y(), 1.5);
  EXPECT_NEAR(objects[0].velocity.x(), 10, 0.5);
}

/** The first detections contain the shadow that the person leaves on a wall. */
TEST(TrackedClusters, sizesOfTheFirstDetectionsAreForgottenWithHindsight)
{
  const auto trackWith = [](MovingLabels labels)
  {
    Tracker tracker({}, labels);
    TrackedObject object;
    for (int scan = 0; scan < 40; ++scan)
    {
      const double behind = std::max(0.0, 1.2 - 0.4 * scan);  // extent of the rest [m]
      Detection person = clusterAt({5 + 0.13 * scan - behind / 2, -6});
      person.box.size = {0.6 + behind, 0.5, 1.7};
      object = tracker.update(dt * scan, {person}, Pose::Identity()).back();
      EXPECT_EQ(object.id, 0) << scan;
    }
    return object;
  };
  const TrackedObject person = trackWith(MovingLabels::hindsight);
  EXPECT_EQ(person.object_class, ObjectClass::pedestrian);
  EXPECT_LT(person.box.size.x(), 1.2);
  EXPECT_GT(trackWith(MovingLabels::causal).box.size.x(), 1.3) << "parts may be missing";
}

/** Another person comes close behind, so that both are one cluster, and falls back again. */
TEST(TrackedClusters, personsHaveTheirOwnSizeAgainWithHindsight)
{
  const auto trackWith = [](MovingLabels labels)
  {
    Tracker tracker({}, labels);
    TrackedObject object;
    for (int scan = 0; scan < 60; ++scan)
    {
      const double behind = std::max(0.0, 1.6 - 0.2 * std::abs(scan - 20));  // extent of both [m]
      Detection person = clusterAt({5 + 0.13 * scan - behind / 2, -6});
      person.box.size = {0.6 + behind, 0.5, 1.7};
      person.object_class = classifyBySize(person.box.size);
      object = tracker.update(dt * scan, {person}, Pose::Identity()).back();
      EXPECT_EQ(object.id, 0) << scan;
    }
    return object;
  };
  const TrackedObject person = trackWith(MovingLabels::hindsight);
  EXPECT_EQ(person.object_class, ObjectClass::pedestrian);
  EXPECT_LT(person.box.size.x(), 0.8);
  EXPECT_GT(trackWith(MovingLabels::causal).box.size.x(), 1.3) << "parts may be missing";
}

TEST(TrackedClusters, vehiclesKeepTheirSizeWhilePartsAreHidden)
{
  Tracker tracker({}, MovingLabels::hindsight);
  TrackedObject object;
  for (int scan = 0; scan < 50; ++scan)
  {
    const double hidden = std::clamp(0.1 * (scan - 20), 0.0, 2.0);  // of its front [m]
    Detection car = clusterAt({-20 + scan - 0.5 * hidden, 8});
    car.box.size.x() -= hidden;
    object = tracker.update(dt * scan, {car}, Pose::Identity()).back();
    EXPECT_EQ(object.id, 0) << scan;
  }
  EXPECT_EQ(object.object_class, ObjectClass::car);
  EXPECT_GT(object.box.size.x(), 3.4);
}

/** Occlusion boundaries on walls move steadily but are thinner than any object. */
TEST(TrackedClusters, thinStripsAreNotReported)
{
  Tracker tracker;
  for (int scan = 0; scan < 30; ++scan)
  {
    Detection strip = clusterAt({-10 + 0.3 * scan, 8});
    strip.box.size = {0.7, 0.1, 1.9};
    Detection person = clusterAt({-5 + 0.13 * scan, -6});
    person.box.size = {0.6, 0.4, 1.6};
    const auto objects = tracker.update(dt * scan, {strip, person}, Pose::Identity());
    ASSERT_EQ(objects.size(), 2u);
    EXPECT_FALSE(objects[0].reported);
    EXPECT_TRUE(scan < 10 || objects[1].reported) << scan;
  }
}

/** After one observation the speed is not known: the second one may be as far away as a vehicle on
 * a motorway drives, by any motion model and at any rate, even if only its front is visible. */
TEST(TrackedClusters, fastVehiclesAreFollowedFromTheirFirstObservation)
{
  for (const TrackMotion motion : {TrackMotion::adaptive, TrackMotion::polynomial,
                                   TrackMotion::constant_velocity, TrackMotion::kalman})
  {
    for (const double interval : {0.05, 0.1, 0.2})
    {
      for (const double length : {0.4, 4.2})
      {
        TrackerOptions options;
        options.motion = motion;
        Tracker tracker(options);
        std::vector<TrackedObject> objects;
        for (int scan = 0; scan < 12; ++scan)
        {
          Detection vehicle = clusterAt({-60 + 40 * interval * scan, 4});
          vehicle.box.size.x() = length;
          objects = tracker.update(interval * scan, {vehicle}, Pose::Identity());
          ASSERT_EQ(objects.size(), 1u) << interval << " " << length << " " << scan;
          EXPECT_EQ(objects[0].id, 0);
        }
        EXPECT_TRUE(objects[0].reported);
        EXPECT_TRUE(objects[0].dynamic);
        EXPECT_NEAR(objects[0].velocity.x(), 40, 1);
      }
    }
  }
}

TEST(TrackedClusters, secondObservationsAreWithinTheSpeedOfTheClass)
{
  const auto tracksAfter = [](ObjectClass object_class, double speed, int confirm_hits)
  {
    TrackerOptions options;
    options.vehicle.confirm_hits = confirm_hits;
    Tracker tracker(options);
    std::size_t count = 0;
    for (int scan = 0; scan < 2; ++scan)
    {
      Detection detection = carAt({speed * dt * scan, 0});
      detection.object_class = object_class;
      count = tracker.update(dt * scan, {detection}, Pose::Identity()).size();
    }
    return count;
  };
  EXPECT_EQ(tracksAfter(ObjectClass::car, 45, 3), 1u);
  EXPECT_EQ(tracksAfter(ObjectClass::car, 55, 3), 2u);
  EXPECT_EQ(tracksAfter(ObjectClass::pedestrian, 14, 3), 1u);
  EXPECT_EQ(tracksAfter(ObjectClass::pedestrian, 25, 3), 2u);
  // Trusted from the first observation on: within gate_distance and like every other track.
  EXPECT_EQ(tracksAfter(ObjectClass::car, 45, 1), 2u);
}

/** A sensor drives along a row of parked cars, 5 m apart, of which it sees those nearby, not in
 * every scan. Those seen in turn may not be taken for a car that drives. */
TEST(TrackedClusters, parkedCarsInARowDoNotMove)
{
  for (const double interval : {0.1, 0.2})
  {
    for (const double speed : {5.0, 15.0, 25.0})
    {
      std::mt19937 generator(7);
      std::normal_distribution<double> noise(0, 0.05);
      std::bernoulli_distribution seen(0.8);
      Tracker tracker;
      for (int scan = 0; scan < 100; ++scan)
      {
        const double x = speed * interval * scan;
        const Pose T_odom_vehicle = poseFromYpr(x, 0, 0, 0, 0, 0);
        std::vector<Detection> detections;
        for (double at = 5 * std::ceil((x - 15) / 5); at < x + 15; at += 5)
        {
          if (seen(generator))
          {
            detections.push_back(clusterAt({at - x + noise(generator), 4 + noise(generator)}));
          }
        }
        for (const TrackedObject& object :
             tracker.update(interval * scan, detections, T_odom_vehicle))
        {
          EXPECT_FALSE(object.reported) << speed << " " << scan;
          EXPECT_FALSE(object.dynamic) << speed << " " << scan;
        }
      }
    }
  }
}

/** A new, fast car passes a new cluster that stands: each keeps its own detection. */
TEST(TrackedClusters, newTracksOfNeighboursKeepTheirDetections)
{
  Tracker tracker;
  std::vector<TrackedObject> objects;
  for (int scan = 0; scan < 12; ++scan)
  {
    objects = tracker.update(
        dt * scan, {clusterAt({3.5 * scan, 0}), clusterAt({2.5, 2.2}), clusterAt({30, 2.2})},
        Pose::Identity());
    ASSERT_EQ(objects.size(), 3u) << scan;
    for (int i = 0; i < 3; ++i)
    {
      EXPECT_EQ(objects[static_cast<std::size_t>(i)].detection, i) << scan;
    }
  }
  EXPECT_NEAR(objects[0].velocity.x(), 35, 1);
  EXPECT_FALSE(objects[1].reported || objects[2].reported);
}

/** The wide gate of a track of one observation takes nothing from a track that is known. */
TEST(TrackedClusters, newTracksChooseAfterTheOthers)
{
  Tracker tracker;
  for (int scan = 0; scan < 8; ++scan)
  {
    (void)tracker.update(dt * scan, {clusterAt({scan, 0})}, Pose::Identity());
  }
  // A part that flickers appears at the car's side; the car is then seen nearer to that part.
  (void)tracker.update(dt * 8, {clusterAt({8, 0}), clusterAt({8.8, 2})}, Pose::Identity());
  const auto objects = tracker.update(dt * 9, {clusterAt({9, 0.7})}, Pose::Identity());
  ASSERT_EQ(objects.size(), 2u);
  EXPECT_EQ(objects[0].detection, 0);
  EXPECT_EQ(objects[1].detection, -1);
}

/** The visible side is at first shorter than the object's width: the motion resolves the axes. */
TEST(TrackedClusters, motionResolvesLengthAndWidth)
{
  Tracker tracker;
  TrackedObject last;
  for (int scan = 0; scan < 40; ++scan)
  {
    const double length = std::min(4.2, 0.5 + 0.2 * scan);
    Detection front = clusterAt({20 - 0.6 * scan, 3});
    front.box.size = {std::max(length, 1.8), std::min(length, 1.8), 1.5};
    front.box.yaw = length < 1.8 ? M_PI / 2 : 0;
    const auto objects = tracker.update(dt * scan, {front}, Pose::Identity());
    ASSERT_EQ(objects.size(), 1u);
    last = objects[0];
  }
  EXPECT_NEAR(std::abs(wrapAngle(last.box.yaw - M_PI)), 0, 0.15);  // drives towards -x
  EXPECT_GT(last.box.size.x(), 3.5);
  EXPECT_NEAR(last.box.size.y(), 1.8, 0.25);
}
