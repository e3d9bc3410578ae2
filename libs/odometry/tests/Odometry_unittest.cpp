// SPDX-License-Identifier: BSD-3-Clause
// The fusion of prior, segmenter, scan matcher and registration, with a scripted matcher.
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/ScanMatcher.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <limits>
#include <random>

#include "TestScene.h"

namespace dyslam
{
namespace
{
constexpr double scan_period = 0.1;

struct Script
{
  Pose T_previous_current = Pose::Identity();
  bool converged = true;
  bool uses_prior = false;
  std::vector<float> static_confidence;
  MotionPrior seen_prior;  //!< that the matcher was given last
};

class ScriptedMatcher : public ScanMatcher
{
 public:
  explicit ScriptedMatcher(Script& script) : script_(script) {}
  ScanMatch match(const Frame&, const MotionPrior& prior) override
  {
    script_.seen_prior = prior;
    ScanMatch match;
    match.motion.T_previous_current = script_.T_previous_current;
    match.motion.information = informationFromSigmas(0.01, 0.001);
    match.motion.status = script_.converged ? MotionStatus::converged : MotionStatus::not_found;
    match.motion.reason = script_.converged ? "" : "scripted to fail";
    match.static_confidence = script_.static_confidence;
    return match;
  }
  [[nodiscard]] bool usesPrior() const override { return script_.uses_prior; }
  void exchangeState(StateArchive& /*archive*/) override {}
  [[nodiscard]] std::string name() const override { return "scripted"; }

 private:
  Script& script_;
};

class Fusion : public testing::Test
{
 protected:
  void start(const std::vector<std::string>& settings = {})
  {
    Config config;
    for (const std::string& setting : settings)
    {
      config.set(setting);
    }
    ConfigLoader loader(config);
    odometry_ = std::make_unique<Odometry>(loader, pool_, times_,
                                           std::make_unique<ScriptedMatcher>(script_));
    count_ = 0;
  }

  /** The next scan of the street from a pose, as it comes to estimate(). */
  Frame next(const Pose& T_world_vehicle)
  {
    Frame frame = scene_.frame(T_world_vehicle, 0.01, static_cast<unsigned>(count_ + 1));
    frame.index = count_;
    frame.scan.stamp = 100 + scan_period * static_cast<double>(count_++);
    odometry_->predict(frame);
    return frame;
  }
  Frame& estimate(Frame& frame)
  {
    odometry_->estimate(frame);
    odometry_->integrate(frame);
    return frame;
  }
  /** Drives steadily until the motion is known well. \return poses driven */
  Pose settle(const Pose& step, int scans = 6)
  {
    Pose T = Pose::Identity();
    for (int i = 0; i < scans; ++i)
    {
      T = i > 0 ? T * step : T;
      script_.T_previous_current = i > 0 ? step : Pose::Identity();
      Frame frame = next(T);
      estimate(frame);
    }
    return T;
  }

  test::StreetScene scene_;
  ThreadPool pool_{2};
  mrpt::system::CTimeLogger times_{false};
  Script script_;
  std::unique_ptr<Odometry> odometry_;
  std::size_t count_ = 0;
};

TEST_F(Fusion, PredictsTheMotionSoFar)
{
  start();
  const Pose step = poseFromYpr(0.5, 0, 0, 0.02, 0, 0);
  const Pose T = settle(step);
  Frame frame = next(T * step);
  EXPECT_NEAR(frame.dt, scan_period, 1e-6);
  EXPECT_TRUE(frame.prior.reliable);
  EXPECT_LT((frame.prior.T_previous_current.translation() - step.translation()).norm(), 0.02);
  EXPECT_LT((T.inverse() * estimate(frame).T_odom_vehicle).translation().norm(), 0.55);
}

TEST_F(Fusion, TheFirstPriorIsNotReliableUnlessTheSpeedIsKnown)
{
  start();
  EXPECT_FALSE(next(Pose::Identity()).prior.reliable);
  EXPECT_FALSE(next(Pose::Identity()).prior.reliable);
  start({"odometry.start_speed=8"});
  EXPECT_FALSE(next(Pose::Identity()).prior.reliable) << "there is no motion to a first scan";
  const Frame second = next(Pose::Identity());
  EXPECT_TRUE(second.prior.reliable);
  EXPECT_NEAR(second.prior.T_previous_current.translation().x(), 0.8, 1e-6);
}

TEST_F(Fusion, AMotionFarFromAGoodPriorIsRejectedWithAReason)
{
  start();
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  const Pose T = settle(step);
  script_.T_previous_current = poseFromYpr(-0.7, 0, 0, 0, 0, 0);  // the traffic's
  script_.static_confidence.assign(100000, 0.0F);
  Frame frame = next(T * step);
  estimate(frame);
  EXPECT_TRUE(frame.odometry.converged());
  EXPECT_FALSE(frame.odometry_accepted);
  EXPECT_NE(frame.odometry_rejection.find("sigmas from the prior"), std::string::npos);
  EXPECT_TRUE(frame.static_confidence.empty()) << "nor is its confidence used";
  EXPECT_TRUE(frame.motion.converged());
  EXPECT_LT(((T * step).inverse() * frame.T_odom_vehicle).translation().norm(), 0.03);
}

TEST_F(Fusion, AMatcherThatFailedSaysWhy)
{
  start();
  script_.converged = false;
  Frame frame = next(Pose::Identity());
  estimate(frame);
  EXPECT_FALSE(frame.odometry_accepted);
  EXPECT_EQ(frame.odometry_rejection, "scripted to fail");
}

/** A matcher that fuses the prior may only correct it a little. */
TEST_F(Fusion, AnInformedMatcherHasTheTighterGate)
{
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  for (const bool informed : {false, true})
  {
    script_ = Script();
    script_.uses_prior = informed;
    start();
    const Pose T = settle(step);
    script_.T_previous_current = step * poseFromYpr(0.2, 0, 0, 0, 0, 0);
    Frame frame = next(T * step);
    estimate(frame);
    EXPECT_EQ(frame.odometry_accepted, !informed);
    EXPECT_LT(((T * step).inverse() * frame.T_odom_vehicle).translation().norm(), 0.03);
  }
}

TEST_F(Fusion, WithoutRegistrationTheMatchersMotionIsTheMotion)
{
  start({"refine.method=none"});
  const Pose step = poseFromYpr(0.6, 0.1, 0, 0.03, 0, 0);
  Frame first = next(Pose::Identity());
  estimate(first);
  script_.T_previous_current = step;
  Frame second = next(Pose::Identity());
  estimate(second);
  EXPECT_TRUE(second.T_odom_vehicle.isApprox(step, 1e-9));
  EXPECT_TRUE(next(Pose::Identity()).prior.T_previous_current.isApprox(step, 1e-9));
}

TEST_F(Fusion, WithoutRegistrationTheMotionLeadsToThePoseAfterFailuresToo)
{
  start({"refine.method=none", "odometry.start_speed=5"});
  script_.converged = false;
  Pose T_before = Pose::Identity();
  for (int i = 0; i < 30; ++i)
  {
    Frame frame = next(Pose::Identity());
    frame.cloud = Cloud();
    estimate(frame);
    const Pose step = T_before.inverse() * frame.T_odom_vehicle;
    EXPECT_TRUE(frame.motion.T_previous_current.isApprox(step, 1e-9)) << i;
    T_before = frame.T_odom_vehicle;
  }
  EXPECT_NEAR(T_before.translation().x(), 2 * 5, 0.6) << "for 2 s at most";
}

TEST_F(Fusion, WithoutRegistrationAGapKeepsTheVelocity)
{
  for (const bool uses_prior : {false, true})
  {
    script_ = Script();
    script_.uses_prior = uses_prior;
    script_.converged = false;
    start({"refine.method=none", "odometry.start_speed=8"});
    const auto predicted = [this]
    {
      Frame frame = next(Pose::Identity());
      odometry_->resolveInterval(frame, [](const Pose&, double) { return Cloud(); });
      return estimate(frame).prior.T_previous_current.translation().x();
    };
    for (int i = 0; i < 8; ++i)
    {
      (void)predicted();
    }
    count_ += 50;  // scans are missing
    EXPECT_NEAR(predicted(), 16, 1e-6) << "for 2 s at most";
    EXPECT_NEAR(predicted(), 8 * scan_period, 1e-6);
  }
}

/** With an IMU and wheels beside the lidar. */
class OtherSensors : public Fusion
{
 protected:
  /** The next scan, with samples of a steady motion since the one before. */
  Frame nextWith(const Pose& T_world_vehicle, const Pose& step, bool imu, bool wheels)
  {
    Frame frame = scene_.frame(T_world_vehicle, 0.01, static_cast<unsigned>(count_ + 1));
    frame.index = count_;
    frame.scan.stamp = 100 + scan_period * static_cast<double>(count_++);
    const Vector6 velocity = logSE3(step) / scan_period;
    for (int i = 0; i <= 10; ++i)
    {
      const double stamp = frame.scan.stamp - 0.1 * (10 - i) * scan_period;
      if (imu)
      {
        frame.imu.push_back({stamp, velocity.tail<3>(), std::nullopt, Pose::Identity()});
      }
      if (wheels)
      {
        frame.wheels.push_back({stamp, velocity.x(), velocity[5]});
      }
    }
    odometry_->predict(frame);
    return frame;
  }

  /** Error of the position after a number of scans, those from `first_empty` on without points. */
  double errorAfter(const Pose& step, int scans, int first_empty)
  {
    Pose T = Pose::Identity();
    Frame frame;
    for (int i = 0; i < scans; ++i)
    {
      T = i > 0 ? T * step : T;
      frame = nextWith(T, step, true, true);
      if (i >= first_empty)
      {
        frame.cloud = Cloud();
      }
      estimate(frame);
    }
    return (T.inverse() * frame.T_odom_vehicle).translation().norm();
  }
};

TEST_F(OtherSensors, MeasureTheFirstMotion)
{
  start({"motion_sensors.gyroscope_check=false"});
  const Pose step = poseFromYpr(1.9, 0, 0, 0.05, 0, 0);
  Frame first = nextWith(Pose::Identity(), step, true, true);
  EXPECT_FALSE(first.prior.reliable) << "there is no motion to a first scan";
  estimate(first);
  Frame second = nextWith(step, step, true, true);
  EXPECT_TRUE(second.prior.reliable);
  EXPECT_LT(motionSize(logSE3(step.inverse() * second.prior.T_previous_current)), 0.1);
  EXPECT_LT((step.inverse() * estimate(second).T_odom_vehicle).translation().norm(), 0.03);
  EXPECT_NE(odometry_->name().find("+ gyroscope + wheel_odometry"), std::string::npos);
}

TEST_F(OtherSensors, PredictATurnThatTheLastMotionsDoNot)
{
  start({"motion_sensors.gyroscope_check=false"});
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  Pose T = Pose::Identity();
  for (int i = 0; i < 6; ++i)
  {
    T = i > 0 ? T * step : T;
    Frame frame = nextWith(T, step, true, false);
    estimate(frame);
  }
  const Pose turn = poseFromYpr(0.5, 0, 0, 0.15, 0, 0);
  const Frame frame = nextWith(T * turn, turn, true, false);
  EXPECT_LT(rotationAngle(turn.inverse() * frame.prior.T_previous_current), 0.02);
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), 0.5, 0.03);
}

TEST_F(OtherSensors, AreTheMotionWithoutRegistration)
{
  start({"refine.method=none"});
  script_.uses_prior = true;
  script_.converged = false;
  EXPECT_LT(errorAfter(poseFromYpr(0.7, 0, 0, 0.04, 0, 0), 20, 20), 0.5) << "after 13 m";
}

TEST_F(OtherSensors, AreTheMotionWhileScansAreEmpty)
{
  start();
  EXPECT_LT(errorAfter(poseFromYpr(0.4, 0, 0, 0.02, 0, 0), 60, 8), 0.5) << "after 5 s, 21 m";
}

/** Beyond the time of extrapolation the rest of the motion is not known. */
TEST_F(OtherSensors, OneAloneStillGivesItsPartOfTheMotionWhileScansAreEmpty)
{
  script_.converged = false;
  for (const bool imu : {true, false})
  {
    start();
    const Pose step = poseFromYpr(0.4, 0, 0, 0.02, 0, 0);
    Pose T = Pose::Identity();
    Pose T_odom_before = T;
    Frame frame;
    for (int i = 0; i < 60; ++i)
    {
      T_odom_before = frame.T_odom_vehicle;
      T = i > 0 ? T * step : T;
      frame = nextWith(T, step, imu, !imu);
      if (i >= 8)
      {
        frame.cloud = Cloud();
      }
      estimate(frame);
    }
    const Pose last = T_odom_before.inverse() * frame.T_odom_vehicle;
    EXPECT_NEAR(last.translation().x(), imu ? 0 : 0.4, 0.01);
    EXPECT_NEAR(rotationAngle(last), imu ? 0.02 : 0, 1e-3);
    EXPECT_TRUE(frame.motion.T_previous_current.isApprox(last, 1e-9));
    if (imu)
    {
      EXPECT_LT(rotationAngle(T.inverse() * frame.T_odom_vehicle), 0.02) << "after 1.2 rad";
    }
  }
}

TEST_F(OtherSensors, AWrongGyroscopeIsLeftOutWhereScansCannotBeRegisteredWithIt)
{
  start({"motion_sensors.gyroscope_check=false"});
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  const Pose said = poseFromYpr(0.5, 0, 0, 0, 0.6, 0.6);
  Pose T = Pose::Identity();
  Frame frame;
  for (int i = 0; i < 12; ++i)
  {
    T = i > 0 ? T * step : T;
    frame = nextWith(T, i < 4 ? step : said, true, false);
    estimate(frame);
    EXPECT_TRUE(frame.motion.registered()) << i;
  }
  EXPECT_LT(motionSize(logSE3(T.inverse() * frame.T_odom_vehicle)), 0.05);
}

TEST_F(OtherSensors, BridgeMissingScans)
{
  start();
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  Pose T = Pose::Identity();
  const auto resolveInterval = [this](Frame& frame)
  {
    const Cloud cloud = frame.cloud;
    odometry_->resolveInterval(frame, [&cloud](const Pose&, double) { return cloud; });
  };
  for (int i = 0; i < 8; ++i)
  {
    T = i > 0 ? T * step : T;
    Frame frame = nextWith(T, step, false, true);
    resolveInterval(frame);
    estimate(frame);
  }
  constexpr double gap = 0.8;
  const Pose passed = poseFromYpr(gap * 8, 0, 0, 0, 0, 0);  // faster than before
  Frame frame = scene_.frame(T * passed, 0.01, 99);
  frame.scan.stamp = 100 + scan_period * static_cast<double>(count_ - 1) + gap;
  for (double back = gap - 0.05; back > -0.01; back -= 0.05)
  {
    frame.wheels.push_back({frame.scan.stamp - back, 8, 0});
  }
  odometry_->predict(frame);
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), 0.5, 0.03)
      << "of one period, until it is known that scans are missing";
  resolveInterval(frame);
  EXPECT_NEAR(frame.dt, gap, 1e-6);
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), gap * 8, 0.1);
}

/** A segmenter with ego-motion from the appearance prior. */
class SegmenterMotion : public Fusion
{
 protected:
  Frame second(const Pose& T_found, bool with_appearance = true)
  {
    Frame first = next(Pose::Identity());
    first.static_prior.assign(first.cloud.size(), 1.0F);
    estimate(first);
    Frame frame = next(T_found);
    frame.segmenter_motion.emplace();
    frame.segmenter_motion->T_previous_current = T_found;
    frame.static_prior.assign(with_appearance ? frame.cloud.size() : 0, 1.0F);
    return frame;
  }
  const Pose T_ = poseFromYpr(1.5, 0, 0, 0, 0, 0);
};

TEST_F(SegmenterMotion, IsFusedWithThePriorOfTheFirstMotion)
{
  start();
  Frame frame = second(T_);
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), 0, 1e-9);
  estimate(frame);
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), 1.5, 0.02);
  EXPECT_NEAR(script_.seen_prior.T_previous_current.translation().x(), 1.5, 0.02);
  EXPECT_EQ(frame.odometry_rejection,
            "not needed: the first registration starts from the segmenter's motion");
  EXPECT_LT((T_.inverse() * frame.T_odom_vehicle).translation().norm(), 0.03);
}

TEST_F(SegmenterMotion, IsNotUsedWithoutAnAppearancePrior)
{
  start();
  Frame frame = second(T_, false);
  estimate(frame);
  EXPECT_NEAR(script_.seen_prior.T_previous_current.translation().x(), 0, 1e-9);
}

TEST_F(SegmenterMotion, IsNotUsedWhereTheStartSpeedIsKnown)
{
  start({"odometry.start_speed=8"});
  Frame frame = second(T_);
  estimate(frame);
  EXPECT_NEAR(script_.seen_prior.T_previous_current.translation().x(), 0.8, 1e-9);
}

TEST_F(SegmenterMotion, IsNotUsedBetweenScansDeskewedDifferently)
{
  start();
  Frame frame = second(T_);
  frame.cloud.T_sweep = T_;
  estimate(frame);
  EXPECT_NEAR(script_.seen_prior.T_previous_current.translation().x(), 0, 1e-9);
}

TEST_F(SegmenterMotion, WhatLooksMobileGetsNoWeight)
{
  start();
  Frame frame = second(T_);
  frame.static_prior[7] = 0.1F;
  frame.static_prior[8] = 0.3F;
  estimate(frame);
  ASSERT_EQ(frame.static_confidence.size(), frame.cloud.size());
  EXPECT_EQ(frame.static_confidence[7], 0.0F);
  EXPECT_EQ(frame.static_confidence[8], 1.0F);
}

TEST_F(SegmenterMotion, MissingInMostFirstScansIsAWarning)
{
  start();
  for (int i = 0; i < 6; ++i)
  {
    Frame frame = next(Pose::Identity());
    frame.static_prior.assign(frame.cloud.size(), 1.0F);
    estimate(frame);
  }
  ASSERT_EQ(odometry_->warnings().size(), 1U);
  EXPECT_NE(odometry_->warnings()[0].find("odometry.start_speed"), std::string::npos);
}

TEST_F(Fusion, AnEmptyScanGetsThePriorsMotion)
{
  start();
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  const Pose T = settle(step);
  script_.converged = false;
  Frame empty = next(T);
  empty.cloud = Cloud();
  estimate(empty);
  EXPECT_FALSE(empty.motion.converged());
  EXPECT_NEAR(empty.motion.T_previous_current.translation().x(), 0.5, 0.03);
  Frame back = next(T * step * step);
  estimate(back);
  EXPECT_TRUE(back.motion.converged()) << back.motion.reason;
  EXPECT_LT(((T * step * step).inverse() * back.T_odom_vehicle).translation().norm(), 0.05);
}

/** Only the ground. \param seed of the places of the points */
std::vector<Eigen::Vector3f> openField(unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-20, 20);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 5000; ++i)
  {
    const float x = place(random);
    points.emplace_back(x, place(random), 0);
  }
  return points;
}

TEST_F(Fusion, ScansThatDoNotDetermineTheMotionAreAWarning)
{
  for (const bool open : {false, true})
  {
    start();
    for (unsigned i = 0; i < 12; ++i)
    {
      Frame frame = next(Pose::Identity());
      frame.cloud = open ? test::frameOf(openField(i)).cloud : frame.cloud;
      EXPECT_TRUE(estimate(frame).motion.registered()) << frame.motion.reason;
    }
    const std::vector<std::string> warnings = odometry_->warnings();
    ASSERT_EQ(warnings.size(), open ? 1U : 0U);
    if (open)
    {
      EXPECT_EQ(warnings[0].find("11 of 11 registered scans"), 0U) << warnings[0];
    }
  }
}

TEST_F(Fusion, AfterAMisjudgedMotionTheMeanOneIsTried)
{
  start({"motion.acceleration_sigma=10", "motion.angular_acceleration_sigma_deg_s2=600"});
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  const Pose T = settle(step, 12);
  Frame frame = next(T * step);
  frame.prior.T_previous_current = poseFromYpr(0.5, 0, 0, 0.5, 0, 0);  // far off
  script_.converged = false;
  estimate(frame);
  EXPECT_TRUE(frame.motion.converged()) << frame.motion.reason;
  EXPECT_LT(((T * step).inverse() * frame.T_odom_vehicle).translation().norm(), 0.1);
}

TEST_F(Fusion, EmptyScansAreExtrapolatedOverForTwoSeconds)
{
  start();
  const Pose T = settle(poseFromYpr(0.5, 0, 0, 0, 0, 0));
  script_.converged = false;
  Frame empty;
  for (int i = 0; i < 60; ++i)
  {
    empty = next(T);
    empty.cloud = Cloud();
    estimate(empty);
  }
  EXPECT_NEAR((T.inverse() * empty.T_odom_vehicle).translation().norm(), 2 * 5, 0.6);
  EXPECT_TRUE(empty.motion.information.isApprox(empty.prior.information, 0.1))
      << "nothing has measured that the vehicle stands";
  const Frame after = next(T);
  EXPECT_GT(after.prior.information.inverse()(0, 0), 0.1) << "the velocity is uncertain by now";
}
}  // namespace
}  // namespace dyslam
