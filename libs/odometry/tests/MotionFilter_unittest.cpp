// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/odometry/MotionFilter.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <random>

namespace dyslam
{
namespace
{
constexpr double step_time = 0.1;

Matrix6 informationOf(double translation, double rotation)
{
  Matrix6 information = Matrix6::Zero();
  information.diagonal().head<3>().setConstant(1 / (translation * translation));
  information.diagonal().tail<3>().setConstant(1 / (rotation * rotation));
  return information;
}

MotionFilter started(double deviation)
{
  MotionFilter filter{MotionFilterOptions()};
  filter.start(Vector6::Zero(), deviation, 1);
  return filter;
}

TEST(MotionFilter, AfterAGapTheVelocityIsKeptButUncertain)
{
  const MotionFilterOptions options;
  MotionFilter filter = started(20);
  const Pose motion = poseFromYpr(1.2, 0, 0, 0.05, 0, 0);
  for (int i = 0; i < 5; ++i)
  {
    filter.update(step_time, motion, informationOf(1e-3, 1e-4));
  }
  const Pose before = filter.predict(step_time);
  ASSERT_LT(filter.sigma(step_time), 0.05);
  MotionFilter later = filter;
  filter.forget(3);
  EXPECT_TRUE(filter.predict(step_time).isApprox(before));
  EXPECT_NEAR(filter.sigma(step_time), 3 * options.acceleration_sigma * step_time, 0.05);
  later.forget(60);
  EXPECT_NEAR(later.sigma(step_time), options.start_speed_sigma * step_time, 0.05);
}

TEST(MotionFilter, WellSeenMotionsAreRepeated)
{
  MotionFilter filter = started(20);
  const Pose motion = poseFromYpr(1.2, 0.1, 0, 0.05, 0.01, 0);
  filter.update(step_time, motion, informationOf(1e-3, 1e-4));
  EXPECT_LT((filter.predict(step_time).inverse() * motion).translation().norm(), 0.01);
  EXPECT_LT(rotationAngle(filter.predict(step_time).inverse() * motion), 0.002);
  // Half the time, half the distance.
  EXPECT_NEAR(filter.predict(0.5 * step_time).translation().x(), 0.6, 0.01);
  EXPECT_TRUE(filter.predict(0).isApprox(Pose::Identity()));
}

TEST(MotionFilter, SpeedIsKeptWhereAMeasurementIsBlind)
{
  MotionFilter filter = started(20);
  const Pose motion = poseFromYpr(1.5, 0, 0, 0, 0, 0);
  filter.update(step_time, motion, informationOf(0.01, 1e-3));
  Matrix6 blind = informationOf(0.01, 1e-3);
  blind(0, 0) = 0;
  double deviation = 0;
  for (int i = 0; i < 20; ++i)
  {
    const Pose prediction = filter.predict(step_time);
    EXPECT_NEAR(prediction.translation().x(), 1.5, 0.02) << i;
    const double now = filter.information(step_time).inverse()(0, 0);
    EXPECT_GT(now, deviation) << "what is not seen gets less certain";
    deviation = now;
    filter.update(step_time, prediction, blind);
  }
}

TEST(MotionFilter, TellsHowFarOffAPredictionMayBe)
{
  MotionFilter filter = started(20);
  EXPECT_NEAR(filter.sigma(step_time), 2, 0.01) << "20 m/s for 0.1 s";
  filter.update(step_time, Pose::Identity(), informationOf(1e-3, 1e-4));
  EXPECT_LT(filter.sigma(step_time), 0.05);
  EXPECT_GT(filter.sigma(10 * step_time), 1) << "3 m/s^2 for 1 s";
}

TEST(MotionFilter, NoMeasurementLeavesThePredictionAsItWas)
{
  MotionFilter filter = started(1);
  filter.follow(step_time, poseFromYpr(0.7, 0, 0, 0.02, 0, 0));
  const Pose before = filter.predict(step_time);
  filter.update(step_time, before, Matrix6::Zero());
  EXPECT_TRUE(filter.predict(step_time).isApprox(before, 1e-9));
  filter.update(0, poseFromYpr(9, 0, 0, 0, 0, 0), informationOf(1e-3, 1e-3));
  EXPECT_TRUE(filter.predict(step_time).isApprox(before, 1e-9)) << "no time, no motion";
}

TEST(MotionFilter, StaysSoundWithMeasurementsOfAnySize)
{
  MotionFilter filter = started(20);
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i)
  {
    // From no information to far better than the prediction, and not quite symmetric, as float sums
    // are.
    Matrix6 half;
    for (int k = 0; k < 36; ++k)
    {
      half(k / 6, k % 6) = std::pow(10.0, 1 + (i + k) % 4) * normal(random);
    }
    Matrix6 measured = half * half.transpose();
    measured(0, 5) *= 1 + 1e-5;
    if (i % 3 == 0)
    {
      measured.row(0).setZero();
      measured.col(0).setZero();
    }
    filter.update(step_time, poseFromYpr(0.9, 0, 0, 0.01, 0, 0), measured,
                  Vector6::Constant(i % 5 == 0 ? 0.01 : 1));
    const Matrix6 covariance = filter.information(step_time).inverse();
    ASSERT_GT(covariance.diagonal().minCoeff(), 0) << i;
    ASSERT_GT(filter.information(step_time).ldlt().vectorD().minCoeff(), 0) << i;
    ASSERT_LT((filter.predict(step_time).translation() - Eigen::Vector3d(0.9, 0, 0)).norm(), 0.5)
        << i;
  }
}

/** Poses measured with white noise on a straight drive: what the pipeline does with them. */
struct NoisyDrive
{
  double prediction_error = 0;  //!< mean square, forward [m^2]
  double naive_error = 0;       //!< of repeating the last measured motion
  double normalised = 0;        //!< normalised squared error, 1 if consistent
};

NoisyDrive drive(double noise)
{
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  MotionFilterOptions options;
  options.acceleration_sigma = 2;
  MotionFilter filter(options);
  filter.start(Vector6::Zero(), 30, 1);
  constexpr int steps = 400;
  double x = 0;
  double v = 15;
  double found = 0;
  double measured_before = 0;
  double measured_last = 0;
  NoisyDrive result;
  const Matrix6 information = informationOf(noise, 1e-3);
  for (int i = 0; i < steps; ++i)
  {
    const double a = options.acceleration_sigma * normal(random);
    x += step_time * v + 0.5 * step_time * step_time * a;
    v += step_time * a;
    const double prediction = filter.predict(step_time).translation().x();
    const Matrix6 prior = filter.information(step_time);
    if (i > 50)
    {
      const double error = found + prediction - x;
      result.prediction_error += error * error / (steps - 51);
      result.normalised += error * error * prior(0, 0) / (steps - 51);
      const double naive = 2 * measured_last - measured_before - x;
      result.naive_error += naive * naive / (steps - 51);
    }
    const double measured = x + noise * normal(random);
    // The pose that prior and measurement agree on.
    const double share = information(0, 0) / (information(0, 0) + prior(0, 0));
    const double next = found + prediction + share * (measured - found - prediction);
    filter.update(step_time, poseFromYpr(next - found, 0, 0, 0, 0, 0), information);
    found = next;
    measured_before = measured_last;
    measured_last = measured;
  }
  return result;
}

TEST(MotionFilter, NoiseIsAveragedAndDeviationsAreHonest)
{
  const NoisyDrive drive_result = drive(0.3);
  EXPECT_LT(drive_result.prediction_error, 0.25 * drive_result.naive_error);
  EXPECT_GT(drive_result.normalised, 0.7);
  EXPECT_LT(drive_result.normalised, 1.4);
}
}  // namespace
}  // namespace dyslam
