// SPDX-License-Identifier: BSD-3-Clause
// One contract for every scan matcher.
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/ScanMatcher.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cctype>

#include "TestScene.h"

namespace dyslam
{
namespace
{

struct Method
{
  std::string name;
  bool uses_points = true;
  double translation = 0.03;  //!< required accuracy on the test scene [m]
  double rotation = 0.2 * test::degree;
};

std::vector<Method> methods(bool all_of_them = true)
{
  std::vector<Method> all;
  for (const std::string& name : scanMatcherNames())
  {
#ifndef DYSLAM_HAVE_TORCH
    if (scanMatcherNeedsNetworks(name))
    {
      continue;  // throws on construction; see below
    }
#endif
    Method method;
    method.name = name;
    method.uses_points = name != "constant_velocity" && name != "zero_motion";
    if (name == "icp_po2po")
    {
      // Ground rings move with the sensor and hold a point-to-point match back.
      method.translation = 0.08;
      method.rotation = 0.3 * test::degree;
    }
    if (all_of_them || method.uses_points)
    {
      all.push_back(method);
    }
  }
  return all;
}

std::unique_ptr<ScanMatcher> make(const std::string& name, ThreadPool& pool)
{
  const Config config;
  ConfigLoader loader(config);
  return makeScanMatcher(name, loader, pool);
}

MotionPrior priorAt(const Pose& T)
{
  MotionPrior prior;
  prior.T_previous_current = T;
  return prior;
}

MotionEstimate matchFrom(ScanMatcher& matcher, const Frame& frame, const Pose& guess)
{
  return matcher.match(frame, priorAt(guess)).motion;
}

class EveryMatcher : public testing::TestWithParam<Method>
{
 protected:
  test::StreetScene scene_;
  ThreadPool pool_{2};
  Pose T_ =
      poseFromYpr(0.6, 0.05, 0.01, 1.5 * test::degree, 0.2 * test::degree, -0.1 * test::degree);

  MotionEstimate move(const Pose& T, const Pose& guess, ThreadPool& pool)
  {
    const auto matcher = make(GetParam().name, pool);
    EXPECT_TRUE(
        matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity()).converged());
    return matchFrom(*matcher, scene_.frame(T, 0.01, 2), guess);
  }
  void expectNear(const MotionEstimate& estimate, const Pose& T)
  {
    const Pose error = T.inverse() * estimate.T_previous_current;
    EXPECT_LT(error.translation().norm(), GetParam().translation);
    EXPECT_LT(rotationAngle(error), GetParam().rotation);
  }
};

/** Those that use the points. */
class EveryPointMatcher : public EveryMatcher
{
};

TEST_P(EveryMatcher, KnowsItsName)
{
  EXPECT_EQ(make(GetParam().name, pool_)->name(), GetParam().name);
}

TEST_P(EveryMatcher, FirstFrameStandsStill)
{
  const auto matcher = make(GetParam().name, pool_);
  const MotionEstimate first = matchFrom(*matcher, scene_.frame(T_, 0.01, 1), T_);
  EXPECT_TRUE(first.converged());
  EXPECT_TRUE(first.T_previous_current.isApprox(Pose::Identity()));
}

TEST_P(EveryMatcher, GoesOnFromItsState)
{
  const auto matcher = make(GetParam().name, pool_);
  Pose T = Pose::Identity();
  for (unsigned i = 0; i < 3; ++i)
  {
    (void)matchFrom(*matcher, scene_.frame(T, 0.01, i), i == 0 ? Pose::Identity() : T_);
    T = T * T_;
  }
  StateArchive saved;
  saved(*matcher);
  const auto loaded = make(GetParam().name, pool_);
  StateArchive archive(saved.bytes());
  archive(*loaded);
  archive.requireEnd();
  for (unsigned i = 3; i < 6; ++i)
  {
    const Frame frame = scene_.frame(T, 0.01, i);
    const ScanMatch a = matcher->match(frame, priorAt(T_));
    const ScanMatch b = loaded->match(frame, priorAt(T_));
    EXPECT_EQ(a.motion.T_previous_current.matrix(), b.motion.T_previous_current.matrix()) << i;
    EXPECT_EQ(a.motion.information, b.motion.information) << i;
    EXPECT_EQ(a.motion.converged(), b.motion.converged()) << i;
    EXPECT_EQ(a.static_confidence, b.static_confidence) << i;
    T = T * T_;
  }
}

TEST_P(EveryMatcher, FindsKnownMotionForwardAndInverse)
{
  if (!GetParam().uses_points)
  {
    EXPECT_TRUE(
        move(T_, T_, pool_)
            .T_previous_current.isApprox(GetParam().name == "zero_motion" ? Pose::Identity() : T_));
    return;
  }
  for (const Pose& T : {T_, Pose(T_.inverse())})
  {
    const MotionEstimate estimate = move(T, Pose::Identity(), pool_);
    EXPECT_TRUE(estimate.converged()) << estimate.reason;
    EXPECT_TRUE(estimate.reason.empty()) << estimate.reason;
    EXPECT_GT(estimate.inliers, 100U);
    expectNear(estimate, T);
  }
}

TEST_P(EveryPointMatcher, FindsItFromPerturbedStarts)
{
  for (const double sign : {-1.0, 1.0})
  {
    Vector6 off;
    off << 0.3 * sign, -0.1, 0.05, 0.005, -0.005 * sign, 0.02 * sign;
    expectNear(move(T_, T_ * expSE3(off), pool_), T_);
  }
}

TEST_P(EveryMatcher, OnlyPredictsIfItReturnsThePrior)
{
  const Pose guess = T_ * poseFromYpr(0.05, 0.02, 0, 0, 0, 0);
  const MotionEstimate found = move(T_, guess, pool_);
  EXPECT_EQ(make(GetParam().name, pool_)->onlyPredicts(),
            found.T_previous_current.matrix() == guess.matrix());
}

TEST_P(EveryMatcher, InformationIsSymmetricAndPositive)
{
  const MotionEstimate estimate = move(T_, T_, pool_);
  EXPECT_TRUE(estimate.information.isApprox(estimate.information.transpose(), 1e-9));
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(estimate.information);
  EXPECT_GT(solver.eigenvalues()[0], 0);
}

TEST_P(EveryMatcher, UselessFramesGetAReasonAndThePrediction)
{
  const std::vector<Frame> useless{
      test::frameOf({}), test::frameOf({{1, 2, 3}}),
      test::frameOf(std::vector<Eigen::Vector3f>(500, test::nanPoint()))};
  for (const Frame& frame : useless)
  {
    const auto matcher = make(GetParam().name, pool_);
    EXPECT_FALSE(matchFrom(*matcher, frame, T_).converged()) << "as the first frame";
    EXPECT_TRUE(matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), T_).reason.empty());
    const MotionEstimate estimate = matchFrom(*matcher, frame, T_);
    EXPECT_FALSE(estimate.converged());
    EXPECT_FALSE(estimate.reason.empty());
    EXPECT_TRUE(estimate.T_previous_current.isApprox(T_));
  }
}

TEST_P(EveryMatcher, TheReasonNamesScanOrLimits)
{
  const auto failureOn = [&](const Frame& frame)
  {
    const auto matcher = make(GetParam().name, pool_);
    matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), T_);
    return matchFrom(*matcher, frame, T_);
  };
  const MotionEstimate empty =
      failureOn(test::frameOf(std::vector<Eigen::Vector3f>(500, test::nanPoint())));
  EXPECT_EQ(empty.reason, "the scan has only 0 returns");
  EXPECT_EQ(empty.cause, FailureCause::recording);
  Frame cropped = test::frameOf(std::vector<Eigen::Vector3f>(500, {1, 0, 0}));
  cropped.cloud = Cloud();
  const MotionEstimate none_left = failureOn(cropped);
  EXPECT_EQ(
      none_left.reason,
      "only 0 of 500 points are left after preprocess.min_range, own_vehicle_range and max_range");
  EXPECT_EQ(none_left.cause, FailureCause::preprocessing);
  std::fill(cropped.scan.points.begin() + 1, cropped.scan.points.end(), Eigen::Vector3f::Zero());
  EXPECT_EQ(failureOn(cropped).reason, "the scan has only 1 return");
}

TEST_P(EveryPointMatcher, MotionGoesOnAfterAUselessFrame)
{
  const auto matcher = make(GetParam().name, pool_);
  const Pose half = poseFromYpr(0.3, 0, 0, 0, 0, 0);
  matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  matchFrom(*matcher, test::frameOf({}), half);
  // From the predicted pose of the unusable frame.
  const MotionEstimate estimate = matchFrom(*matcher, scene_.frame(T_, 0.01, 2), half);
  expectNear(estimate, half.inverse() * T_);
}

TEST_P(EveryMatcher, UselessFramesHaveNoConfidence)
{
  const auto matcher = make(GetParam().name, pool_);
  matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  matchFrom(*matcher, scene_.frame(T_, 0.01, 2), T_);
  EXPECT_TRUE(matcher->match(test::frameOf({}), priorAt(T_)).static_confidence.empty());
}

TEST_P(EveryPointMatcher, NanPointsAmongGoodOnesDoNoHarm)
{
  const auto matcher = make(GetParam().name, pool_);
  matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  Frame frame = scene_.frame(T_, 0.01, 2);
  for (std::size_t i = 0; i < frame.cloud.size(); i += 50)
  {
    frame.cloud.points[i] = test::nanPoint();
  }
  expectNear(matchFrom(*matcher, frame, Pose::Identity()), T_);
}

TEST_P(EveryPointMatcher, MovingPointsCanBeWeighedOut)
{
  // Everything on the left is carried 0.6 m ahead between the scans.
  const auto matcher = make(GetParam().name, pool_);
  matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  Frame frame = scene_.frame(T_, 0.01, 2);
  for (Eigen::Vector3f& p : frame.cloud.points)
  {
    const bool moves = p.y() > 3 && p.z() > 0.3F;
    p.x() += moves ? 0.6F : 0.0F;
    frame.moving_probability.push_back(moves ? 1.0F : 0.0F);
  }
  expectNear(matchFrom(*matcher, frame, T_), T_);
}

TEST_P(EveryMatcher, SameBytesForAnyNumberOfThreads)
{
  ThreadPool one(1);
  ThreadPool three(3);
  const MotionEstimate a = move(T_, Pose::Identity(), one);
  const MotionEstimate b = move(T_, Pose::Identity(), three);
  EXPECT_EQ(a.T_previous_current.matrix(), b.T_previous_current.matrix());
  EXPECT_EQ(a.information, b.information);
}

const auto nameOf = [](const testing::TestParamInfo<Method>& test_info)
{ return test_info.param.name; };
INSTANTIATE_TEST_SUITE_P(Methods, EveryMatcher, testing::ValuesIn(methods()), nameOf);
INSTANTIATE_TEST_SUITE_P(Methods, EveryPointMatcher, testing::ValuesIn(methods(false)), nameOf);

TEST(MakeScanMatcher, OnlyDyloNeedsTheNetworks)
{
  for (const std::string& name : scanMatcherNames())
  {
    EXPECT_EQ(scanMatcherNeedsNetworks(name), name == "dylo") << name;
  }
  EXPECT_FALSE(scanMatcherNeedsNetworks("unknown"));
}

TEST(MakeScanMatcher, NamesTheNearestMethod)
{
  ThreadPool pool(1);
  try
  {
    make("icp_po2p", pool);
    FAIL() << "an unknown name was accepted";
  }
  catch (const UserError& e)
  {
    EXPECT_NE(std::string(e.what()).find("icp_po2p"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("did you mean 'icp_po2"), std::string::npos) << e.what();
  }
}

/** One ini serves all methods, and is checked whole. */
TEST(MakeScanMatcher, SectionsOfOtherMethodsAreKnown)
{
  ThreadPool pool(1);
  Config config;
  config.set("icp_po2pl.sample_size=0.5");
  config.set("dylo.threads=2");
  ConfigLoader loader(config);
  EXPECT_NO_THROW(makeScanMatcher("icp_po2po", loader, pool));
  EXPECT_NO_THROW(loader.requireAllUsed());
  config.set("icp_po2pl.sample_size=-3");
  ConfigLoader wrong(config);
  EXPECT_THROW(makeScanMatcher("icp_po2po", wrong, pool), UserError);
}

/** Methods that share an implementation have only the options that they use. */
TEST(MakeScanMatcher, OptionsWithoutEffectAreRefused)
{
  ThreadPool pool(1);
  const auto isAccepted = [&](const std::string& setting)
  {
    Config config;
    config.set(setting);
    ConfigLoader loader(config);
    try
    {
      (void)makeScanMatcher("zero_motion", loader, pool);
    }
    catch (const UserError&)
    {
      return false;
    }
    return true;
  };
  for (const std::string option : {"loss_width=0.2", "neighbours=12", "normal_radius=0.8"})
  {
    EXPECT_TRUE(isAccepted("icp_po2pl." + option)) << option;
    EXPECT_FALSE(isAccepted("icp_po2po." + option)) << option;
  }
  for (const std::string option :
       {"map_distance=0.5", "map_edge_size=0.2", "map_plane_size=0.4", "map_radius=50"})
  {
    EXPECT_TRUE(isAccepted("loam." + option)) << option;
    EXPECT_FALSE(isAccepted("loam_no_mapping." + option)) << option;
  }
}

/** Without correspondences in the map the motion is that between the scans. */
TEST(Loam, TheMapIsSearchedAsFarAsItsDistance)
{
  const test::StreetScene scene;
  ThreadPool pool(2);
  const Pose T = poseFromYpr(0.6, 0.05, 0.01, 1.5 * test::degree, 0, 0);
  const auto motionBy = [&](const std::string& method, const std::string& map_distance)
  {
    Config config;
    config.set("loam.map_distance=" + map_distance);
    ConfigLoader loader(config);
    const auto matcher = makeScanMatcher(method, loader, pool);
    (void)matchFrom(*matcher, scene.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
    return matchFrom(*matcher, scene.frame(T, 0.01, 2), Pose::Identity())
        .T_previous_current.matrix();
  };
  const auto between_scans = motionBy("loam_no_mapping", "1");
  EXPECT_EQ(motionBy("loam", "0.01"), between_scans);
  EXPECT_NE(motionBy("loam", "1"), between_scans);
}
}  // namespace
}  // namespace dyslam
