// SPDX-License-Identifier: BSD-3-Clause
#include "motion/MotionUncertainty.h"

#include <dyslam/base/Error.h>
#include <dyslam/core/MotionAccumulator.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double scan_time = 0.1;

/** Estimate of a registration, far overconfident. */
MotionEstimate estimateOf(const Pose& T_previous_current)
{
  MotionEstimate motion;
  motion.T_previous_current = T_previous_current;
  motion.information = informationFromSigmas(1e-4, 1e-5);
  motion.status = MotionStatus::converged;
  return motion;
}

Matrix6 covarianceOf(const MotionEstimate& motion)
{
  return motion.information.llt().solve(Matrix6::Identity());
}

double sigma(const MotionEstimate& motion, int component)
{
  return std::sqrt(covarianceOf(motion)(component, component));
}

struct Consistency
{
  double step = 0;      //!< mean normalised squared error of the motions
  double keyframe = 0;  //!< of every five together
};

/** A drive whose estimated poses have independent errors. */
Consistency drive(double noise, double angular_noise, const UncertaintyOptions& options)
{
  std::mt19937 rng(7);
  std::normal_distribution<double> unit;
  MotionUncertainty uncertainty(options);
  const Pose step = poseFromYpr(0.6, 0, 0, 0.02, 0, 0);
  Pose error_before = Pose::Identity();
  MotionAccumulator five;
  Pose true_five = Pose::Identity();
  Consistency mean;
  constexpr int motions = 600;
  constexpr int from = 100;
  for (int i = 0; i < motions; ++i)
  {
    Vector6 e;
    for (int k = 0; k < 6; ++k)
    {
      e[k] = (k < 3 ? noise : angular_noise) * unit(rng);
    }
    const Pose error = expSE3(e);
    MotionEstimate motion = estimateOf(error_before.inverse() * step * error);
    error_before = error;
    uncertainty.calibrate(scan_time, informationFromSigmas(1e-4, 1e-5), motion);
    five.add(motion.T_previous_current, covarianceOf(motion), motion.pose_noise);
    true_five = true_five * step;
    const Vector6 off = logSE3(motion.T_previous_current.inverse() * step);
    mean.step += i < from ? 0 : off.dot(motion.information * off) / (motions - from);
    if (i % 5 == 4)
    {
      const Vector6 far = logSE3(five.motion().inverse() * true_five);
      mean.keyframe +=
          i < from ? 0 : far.dot(five.covariance().llt().solve(far)) * 5 / (motions - from);
      five.restart();
      true_five.setIdentity();
    }
  }
  return mean;
}

TEST(MotionUncertainty, IndependentPoseErrorsAreFoundInTheMotions)
{
  UncertaintyOptions options;
  options.window = 100;
  options.jitter_translation = 1;
  options.jitter_rotation = 1;
  options.jitter_drift = 0;
  for (const double scale : {0.2, 1.0, 5.0})
  {
    const Consistency mean = drive(scale * 0.01, scale * 0.001, options);
    EXPECT_NEAR(mean.step, 6, 1.2) << scale;
    EXPECT_NEAR(mean.keyframe, 6, 1.5) << scale;
  }
}

TEST(MotionUncertainty, SteadyAccelerationIsNoJitter)
{
  MotionUncertainty uncertainty(UncertaintyOptions{});
  MotionEstimate motion;
  for (int i = 0; i < 30; ++i)
  {
    motion = estimateOf(poseFromYpr(0.3 + 0.03 * i, 0, 0, 0, 0, 0));
    uncertainty.calibrate(scan_time, informationFromSigmas(1e-4, 1e-5), motion);
  }
  EXPECT_LT(sigma(motion, 0), 1e-3);
}

TEST(MotionUncertainty, ALostScanIsNoJitter)
{
  MotionUncertainty uncertainty(UncertaintyOptions{});
  MotionEstimate motion;
  for (int i = 0; i < 30; ++i)
  {
    const int scans = i % 7 == 3 ? 2 : 1;
    motion = estimateOf(poseFromYpr(1.0 * scans, 0, 0, 0, 0, 0));
    uncertainty.calibrate(scans * scan_time, informationFromSigmas(1e-4, 1e-5), motion);
  }
  EXPECT_LT(sigma(motion, 0), 1e-3);
}

TEST(MotionUncertainty, ADirectionLeftOpenStaysWide)
{
  MotionUncertainty uncertainty(UncertaintyOptions{});
  const Matrix6 prior = informationFromSigmas(0.2, 0.01);
  Matrix6 in_map = informationFromSigmas(0.002, 0.0002);
  in_map.row(0).setZero();
  in_map.col(0).setZero();
  MotionEstimate motion;
  for (int i = 0; i < 30; ++i)
  {
    motion = estimateOf(poseFromYpr(1, 0, 0, 0, 0, 0));
    motion.information = in_map + prior;
    uncertainty.calibrate(scan_time, in_map, motion);
  }
  EXPECT_GT(sigma(motion, 0), 10 * sigma(motion, 1));
  EXPECT_GT(sigma(motion, 0), 0.02);
}

TEST(MotionUncertainty, AMatchersOpenDirectionIsAsUncertainAsItsPrior)
{
  MotionUncertainty uncertainty(UncertaintyOptions{});
  MotionEstimate motion;
  for (int i = 0; i < 30; ++i)
  {
    motion = estimateOf(poseFromYpr(1, 0, 0, 0, 0, 0));
    motion.information = informationFromSigmas(0.02, 0.002);
    motion.information.row(0).setZero();
    motion.information.col(0).setZero();
    uncertainty.calibrateMatch(scan_time, informationFromSigmas(0.2, 0.01), motion);
  }
  EXPECT_NEAR(sigma(motion, 0), 0.2, 0.01);
  EXPECT_NEAR(sigma(motion, 1), std::sqrt(UncertaintyOptions().motion_covariance_scale) * 0.02,
              1e-3);
}

TEST(MotionUncertainty, AFailedMotionIsAsUncertainAsItsPriorAndNotJitter)
{
  MotionUncertainty uncertainty(UncertaintyOptions{});
  const Pose step = poseFromYpr(1, 0, 0, 0, 0, 0);
  MotionEstimate motion;
  for (int i = 0; i < 30; ++i)
  {
    motion = estimateOf(i == 20 ? poseFromYpr(0.5, 0, 0, 0.1, 0, 0) : step);
    if (i == 20)
    {
      motion.status = MotionStatus::not_found;
      motion.information = informationFromSigmas(0.3, 0.02);
    }
    uncertainty.calibrate(scan_time, Matrix6::Zero(), motion);
    if (i == 20)
    {
      EXPECT_NEAR(sigma(motion, 0), 0.3, 0.01);
      EXPECT_NEAR(sigma(motion, 5), 0.02, 0.001);
      EXPECT_TRUE(motion.pose_noise.trace() < 1e-5);
    }
  }
  EXPECT_LT(sigma(motion, 0), 1e-3);
}

TEST(MotionUncertainty, UntilTheJitterIsKnownTheEstimateCountsInFull)
{
  MotionUncertainty uncertainty(UncertaintyOptions{});
  MotionEstimate motion = estimateOf(Pose::Identity());
  const Matrix6 in_map = informationFromSigmas(0.02, 0.002);
  motion.information = in_map;
  uncertainty.calibrate(scan_time, in_map, motion);
  EXPECT_NEAR(sigma(motion, 0), 0.02, 1e-4);
  EXPECT_TRUE(motion.pose_noise.isApprox(covarianceOf(motion), 1e-6));
}

TEST(MotionUncertainty, AFirstScanHasNoMotionAndOptionsAreChecked)
{
  MotionUncertainty uncertainty(UncertaintyOptions{});
  MotionEstimate motion = estimateOf(Pose::Identity());
  const Matrix6 before = motion.information;
  uncertainty.calibrate(0, before, motion);
  EXPECT_EQ(motion.information, before);
  UncertaintyOptions bad;
  bad.window = 0;
  EXPECT_THROW(MotionUncertainty{bad}, UserError);
}
}  // namespace
}  // namespace dyslam
