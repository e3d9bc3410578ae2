// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/MotionSensors.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double scan_interval = 0.1;  //!< of the scans [s]
constexpr double imu_period = 0.01;    //!< [s]
constexpr double wheel_period = 0.02;  //!< [s]

/** The gyroscope is used from the first scan on. */
MotionSensorOptions unchecked()
{
  MotionSensorOptions options;
  options.gyroscope_check = false;
  return options;
}

/** A vehicle that drives a slalom over a rough road. */
Vector6 velocityAt(double t)
{
  Vector6 v = Vector6::Zero();
  v.x() = 8 + 2 * std::sin(t);
  v[4] = 0.05 * std::sin(9 * t);
  v[5] = 0.4 * std::cos(2 * t);
  return v;
}

/** Its motion, by small steps. */
Pose motionBetween(double begin, double end)
{
  constexpr int steps = 1000;
  Pose T = Pose::Identity();
  for (int i = 0; i < steps; ++i)
  {
    const double dt = (end - begin) / steps;
    T = T * expSE3(dt * velocityAt(begin + (i + 0.5) * dt));
  }
  return T;
}

struct Errors
{
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  //!< [rad/s]
  double scale = 1;                                //!< of the speeds
};

/** The sensors' samples since the scan before, with those at both ends. */
Frame frameAt(int scan, const Errors& errors = {}, const Pose& T_vehicle_imu = Pose::Identity())
{
  Frame frame;
  frame.scan.stamp = scan * scan_interval;
  for (int i = 0; i <= std::lround(scan_interval / imu_period); ++i)
  {
    ImuSample sample;
    sample.stamp = frame.scan.stamp - scan_interval + i * imu_period;
    sample.T_vehicle_imu = T_vehicle_imu;
    sample.angular_velocity =
        T_vehicle_imu.linear().transpose() * (velocityAt(sample.stamp).tail<3>() + errors.bias);
    frame.imu.push_back(sample);
  }
  for (int i = 0; i <= std::lround(scan_interval / wheel_period); ++i)
  {
    const double t = frame.scan.stamp - scan_interval + i * wheel_period;
    frame.wheels.push_back({t, errors.scale * velocityAt(t).x(), velocityAt(t)[5]});
  }
  return frame;
}

SensedMotion sensedBefore(MotionSensors& sensors, const Frame& frame)
{
  const auto sensed =
      sensors.sense(frame.scan.stamp - scan_interval, frame.scan.stamp, Pose::Identity());
  if (!sensed)
  {
    ADD_FAILURE() << "nothing sensed";
    return {};
  }
  return *sensed;
}

/** Adds a frame and compares what it senses with a motion that the scans show. \return whether the
 * gyroscope was used */
bool compareWith(MotionSensors& sensors, const Frame& frame, const Pose& T_found)
{
  sensors.add(frame);
  const SensedMotion sensed = sensedBefore(sensors, frame);
  MotionPrior prior;
  prior.T_previous_current = sensed.T_previous_current;
  prior.information = informationFromSigmas(0.03, 0.01);
  const Matrix6 fused = sensors.fuse(sensed, prior);
  sensors.compare(sensed, fused, scan_interval, T_found, informationFromSigmas(0.001, 0.0001));
  return fused(3, 3) > 0;
}

Pose motionBefore(const Frame& frame)
{
  return motionBetween(frame.scan.stamp - scan_interval, frame.scan.stamp);
}

TEST(MotionSensors, IntegrateRotationAndDisplacement)
{
  MotionSensors sensors{unchecked()};
  const Frame frame = frameAt(7);
  sensors.add(frame);
  const SensedMotion sensed = sensedBefore(sensors, frame);
  const Pose T = motionBetween(0.6, 0.7);
  EXPECT_LT(motionSize(logSE3(T.inverse() * sensed.T_previous_current)), 1e-3);
  ASSERT_TRUE(sensed.rotation && sensed.displacement);
  EXPECT_TRUE(sensed.rotation->isApprox(sensed.T_previous_current.linear(), 1e-9));
  EXPECT_NEAR(*sensed.displacement, logSE3(T).x(), 1e-3);
  for (const int known : {0, 3, 4, 5})
  {
    EXPECT_GT(sensed.information(known, known), 0) << known;
  }
  EXPECT_EQ(sensed.information(1, 1), 0) << "wheels do not measure a drift sideways";
  EXPECT_EQ(sensed.information(2, 2), 0);
  EXPECT_EQ(sensors.name(), " + gyroscope + wheel_odometry");
}

TEST(MotionSensors, TheImusAxesAreTurnedToTheVehicles)
{
  MotionSensors sensors{unchecked()};
  const Frame frame = frameAt(7, {}, poseFromYpr(1, 2, 3, 0.5, -1, 2));
  sensors.add(frame);
  const Pose T = motionBetween(0.6, 0.7);
  EXPECT_LT(rotationAngle(T.inverse() * sensedBefore(sensors, frame).T_previous_current), 1e-4);
}

TEST(MotionSensors, EachServesAloneAndCanBeSwitchedOff)
{
  MotionSensorOptions options = unchecked();
  const Pose T = motionBetween(0.6, 0.7);
  {
    Frame frame = frameAt(7);
    frame.wheels.clear();
    MotionSensors sensors(options);
    sensors.add(frame);
    const auto sensed = sensors.sense(0.6, 0.7, poseFromYpr(0.7, 0, 0, 0, 0, 0));
    ASSERT_TRUE(sensed);
    EXPECT_FALSE(sensed->displacement);
    EXPECT_EQ(sensed->information(0, 0), 0);
    EXPECT_NEAR(logSE3(sensed->T_previous_current).x(), 0.7, 1e-4) << "as predicted";
    EXPECT_LT(rotationAngle(T.inverse() * sensed->T_previous_current), 1e-4);
  }
  options.gyroscope = false;
  Frame frame = frameAt(7);
  MotionSensors sensors(options);
  sensors.add(frame);
  const auto sensed = sensors.sense(0.6, 0.7, poseFromYpr(0.1, 0, 0, 0.03, 0, 0));
  ASSERT_TRUE(sensed);
  EXPECT_FALSE(sensed->rotation);
  EXPECT_NEAR(rotationAngle(sensed->T_previous_current), 0.03, 1e-9) << "as predicted";
  EXPECT_NEAR(logSE3(sensed->T_previous_current).x(), logSE3(T).x(), 1e-3);
  EXPECT_EQ(sensed->information(3, 3), 0);
  EXPECT_EQ(sensors.name(), " + wheel_odometry");

  options.wheel_odometry = false;
  MotionSensors none(options);
  none.add(frame);
  EXPECT_FALSE(none.sense(0.6, 0.7, Pose::Identity()));
  EXPECT_EQ(none.name(), "");
}

TEST(MotionSensors, AGapWithoutSamplesIsNotBridged)
{
  MotionSensorOptions options;
  options.max_gap = 0.05;
  MotionSensors sensors(options);
  sensors.add(frameAt(1));
  sensors.add(frameAt(3));
  EXPECT_TRUE(sensors.sense(0, 0.1, Pose::Identity()));
  EXPECT_FALSE(sensors.sense(0.1, 0.2, Pose::Identity()));
  EXPECT_FALSE(sensors.sense(0, 0.3, Pose::Identity())) << "a gap in between";
  EXPECT_TRUE(sensors.sense(0.21, 0.3, Pose::Identity()));
  EXPECT_TRUE(sensors.sense(0.25, 0.34, Pose::Identity())) << "the last ones are a little older";
  EXPECT_FALSE(sensors.sense(0.25, 0.4, Pose::Identity()));
  EXPECT_FALSE(sensors.sense(-0.2, 0.1, Pose::Identity()));
  EXPECT_TRUE(sensors.sense(0.05, 0.12, Pose::Identity())) << "later samples do no harm";
  EXPECT_TRUE(sensors.speedAt(0.33));
  EXPECT_TRUE(sensors.speedAt(0.12));
  EXPECT_FALSE(sensors.speedAt(0.16));
}

TEST(MotionSensors, WhereTheLastSampleIsOldTheMotionIsLessCertain)
{
  MotionSensors sensors{unchecked()};
  sensors.add(frameAt(7));
  const auto whole = sensors.sense(0.6, 0.7, Pose::Identity());
  const auto held = sensors.sense(0.7, 0.8, Pose::Identity());
  ASSERT_TRUE(whole && held);
  for (const int i : {0, 3, 4, 5})
  {
    EXPECT_LT(held->information(i, i), 0.8 * whole->information(i, i)) << i;
    EXPECT_GT(held->information(i, i), 0) << i;
  }
}

TEST(MotionSensors, SamplesThatMakeNoSenseAreLeftOut)
{
  MotionSensors sensors{unchecked()};
  Frame frame = frameAt(5);
  Frame wrong = frame;
  for (ImuSample& sample : wrong.imu)
  {
    sample.angular_velocity.setConstant(50);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  frame.imu.front().angular_velocity.y() = nan;
  frame.wheels.front().forward_speed = nan;
  frame.wheels.insert(frame.wheels.begin() + 2, {nan, 5, 0});
  frame.wheels.insert(frame.wheels.begin() + 2, {frame.scan.stamp + 3600, 5, 0});
  sensors.add(frame);
  sensors.add(wrong);  // at the same times
  const SensedMotion sensed = sensedBefore(sensors, frame);
  EXPECT_LT(motionSize(logSE3(motionBefore(frame).inverse() * sensed.T_previous_current)), 0.02);
  sensors.add(frameAt(500));
  EXPECT_FALSE(sensors.sense(0.4, 0.5, Pose::Identity())) << "long ago";
  sensors.add(frameAt(7));
  EXPECT_TRUE(sensors.sense(0.6, 0.7, Pose::Identity())) << "the clock was set back";
}

/** A damaged sample must not make the pose of the vehicle NaN. */
TEST(MotionSensors, ImpossibleRatesAndSpeedsAreLeftOut)
{
  const Frame good = frameAt(5);
  for (const double wild : {1e6, 1e38, 1e200, -1.7e308})
  {
    MotionSensors sensors{unchecked()};
    Frame frame = good;
    frame.imu[4].angular_velocity.z() = wild;
    frame.wheels[2].forward_speed = wild;
    sensors.add(frame);
    const SensedMotion sensed = sensedBefore(sensors, frame);
    EXPECT_LT(motionSize(logSE3(motionBefore(good).inverse() * sensed.T_previous_current)), 0.02)
        << wild;
    MotionPrior prior;
    prior.information = informationFromSigmas(0.03, 0.01);
    (void)sensors.fuse(sensed, prior);
    EXPECT_TRUE(prior.T_previous_current.matrix().allFinite()) << wild;
  }
}

/** Feeds the sensors while the scans show the true motion, with a little noise. */
void drive(MotionSensors& sensors, const Errors& errors, int scans)
{
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.002);
  for (int scan = 1; scan <= scans; ++scan)
  {
    Vector6 error;
    error << noise(random), noise(random), noise(random), 0.1 * noise(random), 0.1 * noise(random),
        0.1 * noise(random);
    const Frame frame = frameAt(scan, errors);
    compareWith(sensors, frame, motionBefore(frame) * expSE3(error));
  }
}

TEST(MotionSensors, EstimateBiasAndScale)
{
  MotionSensors sensors{unchecked()};
  const Errors errors{{0.01, -0.008, 0.012}, 1.04};
  const Frame first = frameAt(0, errors);
  sensors.add(first);
  const SensedMotion before = sensedBefore(sensors, first);
  drive(sensors, errors, 200);
  const Frame frame = frameAt(201, errors);
  sensors.add(frame);
  const SensedMotion after = sensedBefore(sensors, frame);
  EXPECT_LT(rotationAngle(motionBefore(frame).inverse() * after.T_previous_current),
            scan_interval * 0.002);
  const double forward = logSE3(motionBefore(frame)).x();
  EXPECT_NEAR(*after.displacement, forward, 0.005 * forward);
  EXPECT_GT(after.information(5, 5), before.information(5, 5));
  EXPECT_GT(after.information(0, 0), before.information(0, 0));
  EXPECT_TRUE(sensors.warnings().empty());
}

/** What was found contains the sensors' own motion, the more the less the scans show. */
TEST(MotionSensors, LearnNothingWhereTheScansShowNothing)
{
  MotionSensors sensors{unchecked()};
  const Errors errors{{0.01, 0, 0}, 1.04};
  for (int scan = 1; scan <= 50; ++scan)
  {
    const Frame frame = frameAt(scan, errors);
    sensors.add(frame);
    const SensedMotion sensed = sensedBefore(sensors, frame);
    sensors.compare(sensed, sensed.information, scan_interval, sensed.T_previous_current,
                    informationFromSigmas(1, 0.1));
  }
  MotionSensors fresh{unchecked()};
  const Frame frame = frameAt(51, errors);
  sensors.add(frame);
  fresh.add(frame);
  EXPECT_EQ(sensedBefore(sensors, frame).information, sensedBefore(fresh, frame).information);
}

TEST(MotionSensors, AGyroscopeIsUsedOnlyWhileItFitsTheScans)
{
  const Errors wrong_axes{{0.5, 0, 0}, 1};
  MotionSensors sensors{unchecked()};
  drive(sensors, {}, 10);
  int used = 0;
  for (int scan = 11; scan <= 60; ++scan)
  {
    const Frame frame = frameAt(scan, wrong_axes);
    used += compareWith(sensors, frame, motionBefore(frame)) ? 1 : 0;
  }
  EXPECT_GT(used, 3);
  EXPECT_LT(used, 15);
  ASSERT_EQ(sensors.warnings().size(), 1U);
  EXPECT_NE(sensors.warnings()[0].find("the gyroscope contradicts the scans in 49 of 60 motions"),
            std::string::npos)
      << sensors.warnings()[0];
  const Frame unused = frameAt(61);
  sensors.add(unused);
  EXPECT_LT(rotationAngle(sensedBefore(sensors, unused).T_previous_current), 1e-9)
      << "as predicted";
  for (int scan = 62; scan <= 80; ++scan)
  {
    const Frame frame = frameAt(scan);
    used = compareWith(sensors, frame, motionBefore(frame)) ? 1 : 0;
  }
  EXPECT_EQ(used, 1) << "it fits again";
}

/** A frame whose angular velocities are stated in deg/s. */
Frame inDegrees(Frame frame)
{
  for (ImuSample& sample : frame.imu)
  {
    sample.angular_velocity /= radians_per_degree;
  }
  return frame;
}

/** Drives with a gyroscope in deg/s: the prior is the motion before. \return number of motions for
 * which the gyroscope was used */
int driveInDegrees(MotionSensors& sensors, int begin, int end)
{
  int used = 0;
  for (int scan = begin; scan < end; ++scan)
  {
    const Frame frame = inDegrees(frameAt(scan));
    sensors.add(frame);
    const SensedMotion sensed = sensedBefore(sensors, frame);
    MotionPrior prior;
    prior.T_previous_current = motionBefore(frameAt(scan - 1));
    prior.information = informationFromSigmas(0.03, 0.01);
    const Matrix6 fused = sensors.fuse(sensed, prior);
    sensors.compare(sensed, fused, scan_interval, motionBefore(frame),
                    informationFromSigmas(0.001, 0.0001));
    used += fused(3, 3) > 0 ? 1 : 0;
  }
  return used;
}

TEST(MotionSensors, AGyroscopeInDegreesIsRecognisedAndNotUsed)
{
  MotionSensors sensors{MotionSensorOptions()};
  EXPECT_LE(driveInDegrees(sensors, 1, 100), 2);
  ASSERT_EQ(sensors.warnings().size(), 1U);
  EXPECT_NE(sensors.warnings()[0].find("57 times those of the scans"), std::string::npos)
      << sensors.warnings()[0];
  EXPECT_NE(sensors.warnings()[0].find("motion_sensors.gyroscope_unit=deg_s"), std::string::npos);
  EXPECT_EQ(sensors.name(), " + wheel_odometry");
  for (int scan = 101; scan <= 150; ++scan)
  {
    const Frame frame = frameAt(scan);
    EXPECT_FALSE(compareWith(sensors, frame, motionBefore(frame))) << "not even where it fits";
  }
}

TEST(MotionSensors, WhatIsKnownOfTheUnitIsKeptInTheState)
{
  MotionSensors whole{MotionSensorOptions()};
  MotionSensors first{MotionSensorOptions()};
  driveInDegrees(whole, 1, 100);
  driveInDegrees(first, 1, 8);
  StateArchive saved;
  first.exchangeState(saved);
  MotionSensors resumed{MotionSensorOptions()};
  StateArchive loaded(saved.bytes());
  resumed.exchangeState(loaded);
  EXPECT_TRUE(first.warnings().empty()) << "too early to tell";
  driveInDegrees(resumed, 8, 100);
  EXPECT_EQ(resumed.warnings(), whole.warnings());
}

TEST(MotionSensors, TheUnitOfTheOptionsCounts)
{
  MotionSensorOptions options = unchecked();
  options.gyroscope_unit = GyroscopeUnit::deg_s;
  MotionSensors sensors(options);
  const Frame frame = inDegrees(frameAt(7));
  sensors.add(frame);
  EXPECT_LT(rotationAngle(motionBefore(frame).inverse() *
                          sensedBefore(sensors, frame).T_previous_current),
            1e-4);
  EXPECT_GT(driveInDegrees(sensors, 8, 60), 50);
  EXPECT_TRUE(sensors.warnings().empty());
}

/** Another scale than that of degrees: the sensor may be wrong for a part of the drive only. */
TEST(MotionSensors, AGyroscopeWithAnotherErrorIsNotSaidToBeInDegrees)
{
  MotionSensors sensors{MotionSensorOptions()};
  for (int scan = 1; scan <= 100; ++scan)
  {
    Frame frame = frameAt(scan);
    for (ImuSample& sample : frame.imu)
    {
      sample.angular_velocity *= 10;
    }
    (void)compareWith(sensors, frame, motionBefore(frame));
  }
  ASSERT_EQ(sensors.warnings().size(), 1U);
  EXPECT_NE(sensors.warnings()[0].find("its rotations are not those of the scans"),
            std::string::npos);
}

TEST(MotionSensors, AGyroscopeIsUsedOnceItsRotationsWereThoseOfTheScans)
{
  MotionSensors sensors{MotionSensorOptions()};
  const Errors errors{{0.03, 0, -0.03}, 1};
  int used = 0;
  for (int scan = 1; scan < 10; ++scan)
  {
    used += compareWith(sensors, frameAt(scan, errors), motionBefore(frameAt(scan))) ? 1 : 0;
  }
  EXPECT_EQ(used, 0);
  EXPECT_EQ(sensors.name(), " + wheel_odometry");
  for (int scan = 10; scan < 60; ++scan)
  {
    used += compareWith(sensors, frameAt(scan, errors), motionBefore(frameAt(scan))) ? 1 : 0;
  }
  EXPECT_GT(used, 40);
  EXPECT_EQ(sensors.name(), " + gyroscope + wheel_odometry");
  EXPECT_TRUE(sensors.warnings().empty());
}

TEST(MotionSensors, AGyroscopeWithWrongAxesIsNeverUsed)
{
  for (const Eigen::Vector3d& signs : {Eigen::Vector3d(1, -1, -1), Eigen::Vector3d(-1, -1, 1)})
  {
    MotionSensors sensors{MotionSensorOptions()};
    const bool turns_about_z = signs.z() < 0;
    for (int scan = 1; scan <= 100; ++scan)
    {
      Frame frame = frameAt(scan);
      for (ImuSample& sample : frame.imu)
      {
        sample.angular_velocity = sample.angular_velocity.cwiseProduct(signs);
        if (!turns_about_z)
        {
          std::swap(sample.angular_velocity.x(), sample.angular_velocity.z());
        }
      }
      EXPECT_FALSE(compareWith(sensors, frame, motionBefore(frame))) << scan;
    }
    ASSERT_EQ(sensors.warnings().size(), 1U);
    EXPECT_NE(sensors.warnings()[0].find("its rotations are not those of the scans"),
              std::string::npos);
    const Frame next = frameAt(101);
    sensors.add(next);
    EXPECT_FALSE(
        sensors.senseOtherwise(next.scan.stamp - scan_interval, next.scan.stamp, Pose::Identity()));
  }
}

/** Whether it is right shows only when the vehicle turns. */
TEST(MotionSensors, NothingIsSaidOfAGyroscopeThatNeverTurned)
{
  MotionSensors sensors{MotionSensorOptions()};
  std::mt19937 rng(3);
  std::normal_distribution<double> noise(0, 1e-4);
  for (int scan = 1; scan <= 100; ++scan)
  {
    Frame frame = frameAt(scan);
    frame.wheels.clear();
    for (ImuSample& sample : frame.imu)
    {
      sample.angular_velocity = Eigen::Vector3d(noise(rng), noise(rng), noise(rng));
    }
    const Vector6 error = Vector6::NullaryExpr([&] { return noise(rng); });
    EXPECT_FALSE(compareWith(sensors, frame, expSE3(error))) << scan;
  }
  EXPECT_TRUE(sensors.warnings().empty()) << sensors.warnings()[0];
  EXPECT_EQ(sensors.name(), "");
}

TEST(MotionSensors, OtherwiseTheGyroscopeIsUsedWhereItWasNot)
{
  for (const bool is_checked : {true, false})
  {
    MotionSensorOptions options;
    options.gyroscope_check = is_checked;
    MotionSensors sensors(options);
    const Frame frame = frameAt(7);
    sensors.add(frame);
    const SensedMotion sensed = sensedBefore(sensors, frame);
    const auto otherwise = sensors.senseOtherwise(frame.scan.stamp - scan_interval,
                                                  frame.scan.stamp, Pose::Identity());
    ASSERT_TRUE(otherwise);
    const SensedMotion& with = is_checked ? *otherwise : sensed;
    const SensedMotion& without = is_checked ? sensed : *otherwise;
    EXPECT_LT(rotationAngle(motionBefore(frame).inverse() * with.T_previous_current), 1e-3);
    EXPECT_GT(with.information(5, 5), 0);
    EXPECT_LT(rotationAngle(without.T_previous_current), 1e-9) << "as predicted";
    EXPECT_EQ(without.information(5, 5), 0);
    EXPECT_GT(without.information(0, 0), 0) << "the wheels stay";
  }
}

TEST(MotionSensors, ADisplacementFarFromThePriorIsNotUsed)
{
  MotionSensors sensors{MotionSensorOptions()};
  const Errors kilometres_per_hour{{0, 0, 0}, 3.6};
  for (int scan = 1; scan <= 30; ++scan)
  {
    const Frame frame = frameAt(scan, kilometres_per_hour);
    sensors.add(frame);
    const SensedMotion sensed = sensedBefore(sensors, frame);
    MotionPrior prior;
    prior.T_previous_current = motionBefore(frame);
    prior.information = informationFromSigmas(0.03, 0.005);
    const Matrix6 fused = sensors.fuse(sensed, prior);
    EXPECT_EQ(fused(0, 0), 0);
    EXPECT_NEAR(prior.T_previous_current.translation().x(), motionBefore(frame).translation().x(),
                0.01);
    sensors.compare(sensed, fused, scan_interval, motionBefore(frame),
                    informationFromSigmas(0.005, 5e-4));
    prior.information = informationFromSigmas(2, 0.005);
    EXPECT_GT(sensors.fuse(sensed, prior)(0, 0), 0) << "where little is known";
  }
  ASSERT_EQ(sensors.warnings().size(), 1U);
  EXPECT_NE(sensors.warnings()[0].find("wheel odometry contradicts the scans in 30 of 30 motions"),
            std::string::npos)
      << sensors.warnings()[0];
}

TEST(MotionSensors, ARotationFarFromThePriorOutweighsIt)
{
  MotionSensors sensors{unchecked()};
  const Frame frame = frameAt(7);
  sensors.add(frame);
  const SensedMotion sensed = sensedBefore(sensors, frame);
  MotionPrior prior;
  prior.T_previous_current = motionBefore(frame) * poseFromYpr(0, 0, 0, 0.3, 0, 0);
  prior.information = informationFromSigmas(0.03, 0.003);
  (void)sensors.fuse(sensed, prior);
  EXPECT_LT(rotationAngle(motionBefore(frame).inverse() * prior.T_previous_current), 0.01);
}

TEST(MotionSensors, SamplesOfAnotherClockAreReported)
{
  MotionSensors sensors{MotionSensorOptions()};
  for (int scan = 1; scan <= 30; ++scan)
  {
    Frame frame = frameAt(scan);
    frame.scan.stamp += 1;
    sensors.add(frame);
    EXPECT_FALSE(
        sensors.sense(frame.scan.stamp - scan_interval, frame.scan.stamp, Pose::Identity()));
  }
  EXPECT_EQ(sensors.name(), "") << "not used";
  ASSERT_EQ(sensors.warnings().size(), 2U);
  EXPECT_NE(sensors.warnings()[0].find("the gyroscope has samples throughout in only 0 of 30"),
            std::string::npos)
      << sensors.warnings()[0];
}

TEST(MotionSensors, AClockThatDiffersByLessIsReported)
{
  for (const double late : {0.0, 0.3})
  {
    MotionSensors sensors{MotionSensorOptions()};
    for (int scan = 1; scan <= 120; ++scan)
    {
      Frame frame = frameAt(scan);
      for (ImuSample& sample : frame.imu)
      {
        sample.stamp += late;
      }
      sensors.add(frame);
      sensors.compareClocks(frame.scan.stamp - scan_interval, frame.scan.stamp,
                            motionBefore(frame));
    }
    const std::vector<std::string> warnings = sensors.warnings();
    ASSERT_EQ(warnings.size(), late > 0 ? 1U : 0U);
    if (late > 0)
    {
      EXPECT_EQ(warnings[0].find("the gyroscope's stamps are about 0.30 s late against"), 0U)
          << warnings[0];
    }
  }
}

TEST(MotionSensors, StateIsKept)
{
  MotionSensors sensors{MotionSensorOptions()};
  const Errors errors{{0.01, -0.008, 0.012}, 1.04};
  drive(sensors, errors, 50);
  StateArchive saved;
  sensors.exchangeState(saved);
  MotionSensors restored{MotionSensorOptions()};
  StateArchive loaded(saved.bytes());
  restored.exchangeState(loaded);
  const Frame frame = frameAt(51, errors);
  sensors.add(frame);
  restored.add(frame);
  EXPECT_EQ(sensedBefore(restored, frame).T_previous_current.matrix(),
            sensedBefore(sensors, frame).T_previous_current.matrix());
  EXPECT_EQ(sensedBefore(restored, frame).information, sensedBefore(sensors, frame).information);
}

TEST(MotionSensors, BadOptionsAreErrors)
{
  MotionSensorOptions options;
  options.wheel_sigma = -1;
  EXPECT_THROW(MotionSensors{options}, UserError);
}
}  // namespace
}  // namespace dyslam
