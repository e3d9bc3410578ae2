// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/Consistency.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace dyslam
{
namespace
{
struct Drive
{
  PosePairs pairs;
  std::vector<MotionCovariance> motions;
};

/** Motions with accumulating errors of the given sigmas, whose stated covariances are scaled by
 * `stated`; every fourth scan is a keyframe. */
Drive drive(std::size_t scans, double stated)
{
  std::mt19937 rng(1);
  std::normal_distribution<double> unit;
  const Matrix6 root = informationFromSigmas(1 / std::sqrt(0.02), 1 / std::sqrt(0.003));
  Drive drive;
  Pose truth = Pose::Identity();
  Pose estimate = poseFromYpr(5, 4, 3, 2, 0, 0);  // of another frame
  for (std::size_t i = 0; i < scans; ++i)
  {
    Vector6 error;
    for (double& e : error)
    {
      e = unit(rng);
    }
    const Pose step = poseFromYpr(0.5, 0, 0, 0.05, 0, 0);
    truth = truth * step;
    estimate = estimate * step * expSE3(root * error);
    drive.pairs.stamps.push_back(0.1 * static_cast<double>(i));
    drive.pairs.reference.push_back(truth);
    drive.pairs.estimate.push_back(estimate);
    MotionCovariance motion;
    motion.stamp = 0.1 * static_cast<double>(i) + 2e-4;
    motion.is_keyframe = i % 4 == 0;
    motion.covariance = stated * stated * root * root.transpose();
    drive.motions.push_back(motion);
  }
  return drive;
}

TEST(Consistency, ExactCovariancesScoreSix)
{
  const Drive d = drive(2001, 1);
  const OdometryConsistency c = odometryConsistency(d.pairs, d.motions, 1e-3);
  EXPECT_EQ(c.steps.all.count, 2000U);
  EXPECT_EQ(c.keyframes.all.count, 500U);
  EXPECT_NEAR(c.steps.all.mean, 6, 0.4);
  EXPECT_NEAR(c.steps.translation.mean, 3, 0.25);
  EXPECT_NEAR(c.steps.rotation.mean, 3, 0.25);
  EXPECT_NEAR(c.keyframes.all.mean, 6, 0.7);
}

TEST(Consistency, TwiceTheSigmaScoresAQuarter)
{
  const Drive exact = drive(500, 1);
  const Drive wide = drive(500, 2);
  const OdometryConsistency a = odometryConsistency(exact.pairs, exact.motions, 1e-3);
  const OdometryConsistency b = odometryConsistency(wide.pairs, wide.motions, 1e-3);
  EXPECT_NEAR(b.steps.all.mean, a.steps.all.mean / 4, 1e-6);
  EXPECT_NEAR(b.keyframes.all.mean, a.keyframes.all.mean / 4, 1e-6);
}

TEST(Consistency, MotionsGetThePosesNearestInTime)
{
  const Drive d = drive(200, 1);
  const OdometryConsistency narrow = odometryConsistency(d.pairs, d.motions, 1e-3);
  const OdometryConsistency wide = odometryConsistency(d.pairs, d.motions, 0.15);
  EXPECT_EQ(wide.steps.all.count, narrow.steps.all.count);
  EXPECT_EQ(wide.steps.all.mean, narrow.steps.all.mean);
  EXPECT_EQ(wide.keyframes.all.mean, narrow.keyframes.all.mean);
}

TEST(Consistency, MotionsWithoutTruthOrCovarianceAreLeftOut)
{
  Drive d = drive(41, 1);
  for (const std::size_t gone : {9U})
  {
    const auto at = static_cast<std::ptrdiff_t>(gone);
    d.pairs.stamps.erase(d.pairs.stamps.begin() + at);
    d.pairs.reference.erase(d.pairs.reference.begin() + at);
    d.pairs.estimate.erase(d.pairs.estimate.begin() + at);
  }
  OdometryConsistency c = odometryConsistency(d.pairs, d.motions, 1e-3);
  EXPECT_EQ(c.steps.all.count, 38U);
  EXPECT_EQ(c.keyframes.all.count, 9U);
  d.motions[20].covariance.setZero();
  c = odometryConsistency(d.pairs, d.motions, 1e-3);
  EXPECT_EQ(c.steps.all.count, 37U);
  EXPECT_EQ(odometryConsistency({}, {}, 1e-3).steps.all.count, 0U);
}
}  // namespace
}  // namespace dyslam
