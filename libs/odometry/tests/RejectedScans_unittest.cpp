// SPDX-License-Identifier: BSD-3-Clause
// Scans that cannot be registered, and those just good enough.
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/Preprocessor.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "RegistrationTest.h"

namespace dyslam
{
namespace
{
using test::drive;
using test::step;

class RejectedScans : public test::RegistrationTest
{
};

TEST_P(RejectedScans, UselessFramesKeepTheGuessAndTheMap)
{
  LocalMapRegistration registration(options(), pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const std::size_t cells = registration.mapPoints().size();
  const Pose guess = poseFromYpr(0.3, 0, 0, 0, 0, 0);
  for (const Frame& frame : {test::frameOf({}), test::frameOf({{1, 2, 3}}),
                             test::frameOf(std::vector<Eigen::Vector3f>(500, test::nanPoint()))})
  {
    const RegistrationResult result = step(registration, frame, guess);
    EXPECT_FALSE(result.motion.registered());
    EXPECT_FALSE(result.motion.reason.empty());
    EXPECT_EQ(result.motion.cause, FailureCause::recording);
    EXPECT_TRUE(result.T_odom_vehicle.isApprox(guess));
    EXPECT_EQ(registration.mapPoints().size(), cells);
  }
  const Pose T = poseFromYpr(0.4, 0, 0, 0.01, 0, 0);
  const RegistrationResult good = step(registration, scene_.frame(T, 0.01, 2), guess);
  EXPECT_TRUE(good.motion.converged()) << good.motion.reason;
  EXPECT_LT((T.inverse() * good.T_odom_vehicle).translation().norm(), 0.03);
}

/** The frame that shows the motion of the first one is not the second: the first one stays where
 * it was. */
TEST_P(RejectedScans, AnEmptySecondFrameLeavesTheFirstInItsPlace)
{
  const std::vector<Pose> poses = drive(6);
  const Preprocessor preprocessor(PreprocessOptions(), pool_);
  LocalMapRegistration registration(options(), pool_);
  Pose motion = Pose::Identity();
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    const Pose T_sweep = poses[0].inverse() * poses[1];
    Frame frame;
    if (i != 1)
    {
      frame.scan = scene_.scan(poses[i], 0.01, static_cast<unsigned>(i + 1), T_sweep);
    }
    frame.cloud = preprocessor.prepare(frame.scan, motion, i == 0 ? 0 : 0.1);
    // The prior of a vehicle whose speed is known.
    motion = T_sweep;
    const RegistrationResult result =
        step(registration, frame, registration.pose() * (i == 0 ? Pose::Identity() : motion), 0.1);
    EXPECT_EQ(result.motion.converged(), i != 1) << i << ": " << result.motion.reason;
    const Pose error = poses[i].inverse() * result.T_odom_vehicle;
    EXPECT_LT(error.translation().norm(), 0.1) << i;
  }
}

/** A registration that max_iterations ends is accepted by its inliers. */
TEST_P(RejectedScans, AScanThatDoesNotSettleIsRegistered)
{
  RefineOptions o = options();
  o.max_iterations = 1;
  LocalMapRegistration registration(o, pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Pose T = poseFromYpr(0.02, 0.06, 0, 0, 0, 0);
  const RegistrationResult result =
      step(registration, scene_.frame(T, 0.01, 2), Pose::Identity(), 0.3);
  EXPECT_EQ(result.motion.status, MotionStatus::not_settled);
  EXPECT_TRUE(result.motion.registered());
  EXPECT_FALSE(result.motion.converged());
  EXPECT_EQ(result.motion.reason, "the registration did not converge");
  EXPECT_LT((T.inverse() * result.T_odom_vehicle).translation().norm(), 0.04) << "not the guess";
  EXPECT_EQ(registration.framesInMap(), 2) << "it is added";
}

TEST_P(RejectedScans, AForeignSceneFailsAndThenRestartsTheMap)
{
  LocalMapRegistration registration(options(), pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  step(registration, scene_.frame(poseFromYpr(0.1, 0, 0, 0, 0, 0), 0.01, 2), Pose::Identity());
  const Frame foreign = test::inTheAir(scene_.frame(Pose::Identity(), 0.01, 3));
  const Pose guess = registration.pose();
  for (int i = 0; i < 5; ++i)
  {
    const RegistrationResult result = step(registration, foreign, guess);
    EXPECT_FALSE(result.motion.registered());
    EXPECT_NE(result.motion.reason.find("local map"), std::string::npos);
    EXPECT_EQ(result.motion.map_restarted, i == 4) << i;
  }
  const RegistrationResult after = step(registration, foreign, guess);
  EXPECT_TRUE(after.motion.converged());
  EXPECT_FALSE(after.motion.map_restarted);
}

TEST_P(RejectedScans, AFirstScanOfAPartOfARevolutionIsReplacedAtOnce)
{
  LocalMapRegistration registration(options(), pool_);
  Frame part = scene_.frame(Pose::Identity(), 0.01, 1);
  Cloud& cloud = part.cloud;
  std::vector<Eigen::Vector3f> sector;
  std::copy_if(cloud.points.begin(), cloud.points.end(), std::back_inserter(sector),
               [](const Eigen::Vector3f& p)
               { return p.x() > 0 && std::abs(p.y()) < 0.1F * p.x(); });
  ASSERT_GT(sector.size(), 100U);
  cloud = Cloud();
  cloud.points = sector;
  part.scan = Scan();
  step(registration, part, Pose::Identity());
  const Pose T = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  const RegistrationResult second = step(registration, scene_.frame(T, 0.01, 2), T);
  const RegistrationResult third = step(registration, scene_.frame(T * T, 0.01, 3), T * T);
  EXPECT_TRUE(second.motion.converged() || second.motion.map_restarted) << second.motion.reason;
  EXPECT_TRUE(third.motion.converged()) << third.motion.reason;
}

/** Value and limit of a rejected scan have the same unit, and the value is below the limit. */
TEST_P(RejectedScans, ARejectedScanHasItsRatioAndTheLimit)
{
  for (const double limit : {1.0, 0.995})
  {
    RefineOptions o = options();
    o.min_inlier_ratio = limit;
    LocalMapRegistration registration(o, pool_);
    step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
    const RegistrationResult result =
        step(registration, scene_.frame(Pose::Identity(), 0.01, 2), Pose::Identity(), 0.1);
    ASSERT_FALSE(result.motion.converged());
    double ratio = 0;
    double read_limit = 0;
    ASSERT_EQ(std::sscanf(result.motion.reason.c_str(),
                          "the scan does not fit the local map: inlier ratio %lf, the limit is %lf "
                          "(refine.min_inlier_ratio)",
                          &ratio, &read_limit),
              2)
        << result.motion.reason;
    EXPECT_EQ(read_limit, limit);
    EXPECT_LT(ratio, limit);
    EXPECT_GT(ratio, result.inlier_ratio - 0.01);
    EXPECT_LE(ratio, result.inlier_ratio);
  }
}

/** The rejected motion has deskewed the first frame. */
TEST_P(RejectedScans, ARejectedSecondFrameLeavesTheMapAsItWas)
{
  RefineOptions o = options();
  o.min_inlier_ratio = 1;
  const std::vector<Pose> poses = drive(2);
  const Preprocessor preprocessor(PreprocessOptions(), pool_);
  LocalMapRegistration registration(o, pool_);
  std::vector<Eigen::Vector3f> map_before;
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    Frame frame;
    frame.scan = scene_.scan(poses[i], 0.01, static_cast<unsigned>(i + 1), poses[1]);
    frame.cloud = preprocessor.prepare(frame.scan, Pose::Identity(), 0.1);
    const RegistrationResult result = step(registration, frame, Pose::Identity());
    EXPECT_EQ(result.motion.converged(), i == 0);
    EXPECT_TRUE(result.T_odom_vehicle.isApprox(Pose::Identity()));
    map_before = i == 0 ? registration.mapPoints() : map_before;
  }
  EXPECT_FALSE(map_before.empty());
  EXPECT_EQ(registration.framesInMap(), 1);
  EXPECT_EQ(registration.mapPoints(), map_before);
}

TEST_P(RejectedScans, ASolutionThatIsNotFiniteIsRejected)
{
  LocalMapRegistration registration(options(), pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Frame frame = scene_.frame(poseFromYpr(0.05, 0, 0, 0, 0, 0), 0.01, 2);
  MotionPrior prior;
  prior.information.setConstant(std::numeric_limits<double>::quiet_NaN());
  LocalMapRegistration::Alignment alignment =
      registration.align(frame, Pose::Identity(), &prior, 0.1);
  const RegistrationResult result = alignment.result();
  registration.commit(std::move(alignment), frame);
  EXPECT_FALSE(result.motion.converged());
  EXPECT_EQ(result.motion.reason, "the registration has no finite solution");
  EXPECT_TRUE(result.T_odom_vehicle.isApprox(Pose::Identity()));
  EXPECT_EQ(registration.framesInMap(), 1) << "it is not added";
  EXPECT_TRUE(step(registration, frame, Pose::Identity(), 0.1).motion.converged());
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         RejectedScans,
                         testing::Values(RefineMethod::point_to_plane, RefineMethod::gicp),
                         test::methodName);
}  // namespace
}  // namespace dyslam
