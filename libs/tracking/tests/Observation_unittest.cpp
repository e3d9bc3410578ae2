// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/tracking/Tracker.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

using namespace dyslam;

namespace
{
constexpr double scan_time = 0.1;  // [s]

Detection car(const Eigen::Vector3d& centre, double yaw)
{
  Detection detection;
  detection.box.centre = centre;
  detection.box.size = {4.2, 1.8, 1.5};
  detection.box.yaw = yaw;
  detection.object_class = ObjectClass::car;
  detection.covariance = Eigen::Vector4d(0.04, 0.01, 0.02, 0.03).asDiagonal();
  return detection;
}
}  // namespace

/** The observation of a box from a file is that box in the odometry frame, unfiltered. */
TEST(TrackedObservation, isTheDetectionInTheOdometryFrame)
{
  const Pose T_odom_vehicle = poseFromYpr(3, -2, 0.5, M_PI / 2, 0, 0);
  Tracker tracker;
  (void)tracker.update(0, {car({10, 1, -0.8}, 0.1)}, T_odom_vehicle);
  const auto objects = tracker.update(scan_time, {car({10.3, 1.2, -0.7}, 0.2)}, T_odom_vehicle);
  ASSERT_EQ(objects.size(), 1u);
  ASSERT_TRUE(objects[0].observed);
  const Box& seen = objects[0].observation;
  // A quarter turn: x of the vehicle is y of the odometry frame.
  EXPECT_NEAR((seen.centre - Eigen::Vector3d(3 - 1.2, -2 + 10.3, 0.5 - 0.7)).norm(), 0, 1e-12);
  EXPECT_NEAR(seen.yaw, M_PI / 2 + 0.2, 1e-12);
  EXPECT_NEAR((seen.size - Eigen::Vector3d(4.2, 1.8, 1.5)).norm(), 0, 1e-12);
  EXPECT_GT((objects[0].box.centre - seen.centre).norm(), 0.01);  // the state is filtered
  const Eigen::Matrix4d expected = Eigen::Vector4d(0.01, 0.04, 0.02, 0.03).asDiagonal();
  EXPECT_NEAR((objects[0].observation_covariance - expected).norm(), 0, 1e-12);
}

TEST(TrackedObservation, isSetAtBirthAndOnlyWhereObserved)
{
  Tracker tracker;
  auto objects = tracker.update(0, {car({8, 3, 0}, 0.3)}, Pose::Identity());
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_TRUE(objects[0].observed);
  EXPECT_NEAR((objects[0].observation.centre - Eigen::Vector3d(8, 3, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(objects[0].observation_covariance(0, 0), 0.04, 1e-12);
  objects = tracker.update(scan_time, {}, Pose::Identity());
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_FALSE(objects[0].observed);
}

/** A detector that sometimes takes the rear for the front. */
TEST(TrackedObservation, headingIsWithinAQuarterTurnOfTheTracks)
{
  Tracker tracker;
  for (int scan = 0; scan < 30; ++scan)
  {
    const double yaw = scan % 4 == 3 ? 0.2 - M_PI : 0.2;
    const auto objects = tracker.update(scan_time * scan, {car({0.8 * scan, 0.16 * scan, 0}, yaw)},
                                        Pose::Identity());
    ASSERT_EQ(objects.size(), 1u);
    EXPECT_NEAR(wrapAngle(objects[0].observation.yaw - 0.2), 0, 1e-9) << scan;
  }
}

/** A car drives towards the lidar and shows its front only, after it was seen whole.
 * \param lidar position in the vehicle frame [m] \return its state at the end */
TrackedObject approachingCar(const Eigen::Vector3d& lidar)
{
  Tracker tracker;
  TrackedObject last;
  for (int scan = 0; scan < 40; ++scan)
  {
    const double visible = scan < 30 ? 4.2 : 0.6;
    Detection front = car(lidar + Eigen::Vector3d(30 - 0.6 * scan + 0.5 * visible, 3, 0),
                          scan < 30 ? 0 : M_PI / 2);
    front.box.size = {visible, 1.8, 1.5};
    if (scan >= 30)
    {
      front.box.size = {1.8, visible, 1.5};  // the longer visible side is the width
    }
    front.points = {0, 1, 2};
    const auto objects = tracker.update(scan_time * scan, {front}, Pose::Identity(), lidar);
    EXPECT_EQ(objects.size(), 1u);
    last = objects.at(0);
    EXPECT_TRUE(last.observed);
  }
  return last;
}

/** Length and width are the car's and the hidden rear is added. */
TEST(TrackedObservation, ofAClusterIsCompletedToTheWholeObject)
{
  const TrackedObject last = approachingCar({0, 0, 0});
  const Box& seen = last.observation;
  EXPECT_NEAR(std::abs(wrapAngle(seen.yaw - last.box.yaw)), 0, 0.1);
  EXPECT_NEAR(seen.size.x(), last.box.size.x(), 1e-9);
  EXPECT_GT(seen.size.x(), 3.5);
  EXPECT_NEAR(seen.size.y(), 1.8, 0.1);
  // The front, the side that faces the sensor, stays where it was seen.
  EXPECT_NEAR(seen.centre.x() - 0.5 * seen.size.x(), 30 - 0.6 * 39, 0.1);
}

/** The lidar is behind the origin of the vehicle, and at the end the car is between them. */
TEST(TrackedObservation, isCompletedOnTheSideThatTheLidarDoesNotSee)
{
  const Eigen::Vector3d lidar(-10, 0, 0);
  const Box seen = approachingCar(lidar).observation;
  EXPECT_GT(seen.size.x(), 3.5);
  EXPECT_NEAR(seen.centre.x() - 0.5 * seen.size.x() - lidar.x(), 30 - 0.6 * 39, 0.1);
}

/** Detections six times as noisy as their covariances say. */
TEST(NoiseOfDetections, IsFoundAndFilteredAway)
{
  const auto run = [](bool adapt)
  {
    std::mt19937 generator(41);
    std::normal_distribution<double> noise(0, 0.3);
    TrackerOptions options;
    options.motion = TrackMotion::kalman;
    options.adapt_noise = adapt;
    options.vehicle.gate_sigmas = 30;
    Tracker tracker(options);
    double squared_errors = 0;
    double variance = 0;
    for (int scan = 0; scan < 300; ++scan)
    {
      const Eigen::Vector2d truth(1.0 * scan, 3);
      Detection detection = car({truth.x() + noise(generator), truth.y() + noise(generator), 0}, 0);
      detection.covariance = Eigen::Vector4d(0.0025, 0.0025, 0.02, 0.03).asDiagonal();
      const auto objects = tracker.update(scan_time * scan, {detection}, Pose::Identity());
      if (scan >= 200)
      {
        EXPECT_EQ(objects.size(), 1u);
        squared_errors += (objects[0].box.centre.head<2>() - truth).squaredNorm() / 200;
        variance = objects[0].observation_covariance(0, 0);
      }
    }
    return std::make_pair(std::sqrt(squared_errors), std::sqrt(variance));
  };
  const auto [error, sigma] = run(true);
  EXPECT_NEAR(sigma, 0.3, 0.04);
  EXPECT_LT(error, 0.2);  // of one coordinate; 0.3 m unfiltered
  const auto [plain_error, stated_sigma] = run(false);
  EXPECT_NEAR(stated_sigma, 0.05, 1e-9);
  EXPECT_GT(plain_error, 0.2);
}

/** With a short memory a track's score follows the last detections. */
TEST(ScoreOfATrack, FollowsItsMemoryAndItsLength)
{
  const auto scoreAfter = [](double memory)
  {
    TrackerOptions options;
    options.vehicle.score_memory = memory;
    options.vehicle.score_prior = 2;
    Tracker tracker(options);
    double score = 0;
    for (int scan = 0; scan < 8; ++scan)
    {
      Detection detection = car({0.5 * scan, 0, 0}, 0);
      detection.score = scan < 4 ? 6 : 2;
      score = tracker.update(scan_time * scan, {detection}, Pose::Identity()).at(0).score;
    }
    return score;
  };
  EXPECT_NEAR(scoreAfter(1), 4.0 * 8 / (8 + 2), 1e-12);  // mean of all, with two zeros
  EXPECT_NEAR(scoreAfter(0), 2.0 * 8 / (8 + 2), 1e-12);  // the last one
  EXPECT_LT(scoreAfter(0.5), scoreAfter(1));
}
