// SPDX-License-Identifier: BSD-3-Clause
#include "motion/MotionPredictor.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
constexpr double sensor_period = 0.1;  // [s]

class MotionPredictorTest : public testing::Test
{
 protected:
  [[nodiscard]] static MotionPredictor started(double speed)
  {
    OdometryOptions start;
    start.start_speed = speed;
    return MotionPredictor(start, MotionFilterOptions(), MotionSensorOptions(), 0.1);
  }
  /** Predicts a scan that comes `interval` seconds after the one before. */
  Frame next(MotionPredictor& predictor, double interval)
  {
    stamp_ += interval;
    Frame frame;
    frame.scan.stamp = stamp_;
    context_ = FrameContext();
    predictor.predict(frame, context_);
    return frame;
  }
  /** Predicts scans at the sensor's rate until the clock knows it. */
  void learnRate(MotionPredictor& predictor)
  {
    for (int i = 0; i < 8; ++i)
    {
      (void)next(predictor, sensor_period);
      EXPECT_FALSE(context_.interval_doubtful) << i;
      predictor.acceptInterval();
    }
  }
  double stamp_ = 100;  // [s]
  FrameContext context_;
};

TEST_F(MotionPredictorTest, AKnownStartSpeedMakesTheSecondPriorReliable)
{
  for (const double speed : {0.0, 8.0})
  {
    MotionPredictor predictor = started(speed);
    const Frame first = next(predictor, sensor_period);
    EXPECT_EQ(first.dt, 0);
    EXPECT_FALSE(first.prior.reliable);
    EXPECT_TRUE(first.prior.T_previous_current.isApprox(Pose::Identity()));
    const Frame second = next(predictor, sensor_period);
    EXPECT_EQ(second.prior.reliable, speed > 0);
    EXPECT_NEAR(second.prior.T_previous_current.translation().x(), speed * sensor_period, 1e-6);
  }
}

TEST_F(MotionPredictorTest, AnIntervalThatDoesNotFitTheRateIsOnePeriodAtFirst)
{
  MotionPredictor predictor = started(8);
  learnRate(predictor);
  const Frame frame = next(predictor, 5);
  EXPECT_TRUE(context_.interval_doubtful);
  EXPECT_NEAR(frame.dt, sensor_period, 1e-6);
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), 8 * sensor_period, 1e-6);
}

TEST_F(MotionPredictorTest, AClockThatWasSetIsCorrected)
{
  MotionPredictor predictor = started(8);
  learnRate(predictor);
  Frame frame = next(predictor, 5);
  predictor.correctInterval(sensor_period, frame, context_);
  EXPECT_NEAR(frame.dt, sensor_period, 1e-6);
  EXPECT_NEAR(frame.clock_offset, 5 - sensor_period, 1e-6);
  EXPECT_FALSE(context_.after_gap);
  EXPECT_EQ(predictor.warnings().size(), 1U);
}

TEST_F(MotionPredictorTest, OverAGapTwoSecondsArePredicted)
{
  MotionPredictor predictor = started(8);
  learnRate(predictor);
  Frame frame = next(predictor, 5);
  predictor.correctInterval(predictor.clock().interval(), frame, context_);
  EXPECT_NEAR(frame.dt, 5, 1e-6);
  EXPECT_EQ(frame.clock_offset, 0);
  EXPECT_TRUE(context_.after_gap);
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), 16, 1e-6);
  EXPECT_TRUE(predictor.warnings().empty());
}

TEST_F(MotionPredictorTest, WheelsAreFusedOverTheIntervalOfTheStampsOnly)
{
  MotionPredictor predictor = started(0);
  (void)next(predictor, sensor_period);
  stamp_ += sensor_period;
  Frame frame;
  frame.scan.stamp = stamp_;
  for (const double back : {sensor_period, 0.5 * sensor_period, 0.0})
  {
    frame.wheels.push_back({stamp_ - back, 8, 0});
  }
  context_ = FrameContext();
  predictor.predict(frame, context_);
  ASSERT_TRUE(context_.sensed.has_value());
  EXPECT_TRUE(predictor.startSpeedKnown()) << "by the wheels";
  EXPECT_GT(context_.sensed_information(0, 0), 0);
  EXPECT_FALSE(context_.isDeadReckoned()) << "nothing measures the rotation";
  EXPECT_NEAR(frame.prior.T_previous_current.translation().x(), 8 * sensor_period, 1e-3);
  MotionPrior prior = predictor.priorAfter(0.5);
  EXPECT_TRUE(predictor.fuseSensed(0.5, context_, prior).isZero());
}

TEST_F(MotionPredictorTest, RegisteredMotionsGiveTheVelocity)
{
  MotionPredictor predictor = started(0);
  (void)next(predictor, sensor_period);
  Frame frame = next(predictor, sensor_period);
  EXPECT_FALSE(predictor.meanVelocityPrior(frame, context_).has_value());
  RegistrationResult registered;
  registered.motion.T_previous_current = poseFromYpr(0.6, 0, 0, 0.02, 0, 0);
  registered.motion.status = MotionStatus::converged;
  registered.measured_information = informationFromSigmas(1e-3, 1e-4);
  registered.points = 1000;
  predictor.update(frame, context_, registered);
  frame = next(predictor, sensor_period);
  const Pose& T_found = registered.motion.T_previous_current;
  EXPECT_TRUE(frame.prior.T_previous_current.isApprox(T_found, 1e-3));
  const auto steady = predictor.meanVelocityPrior(frame, context_);
  ASSERT_TRUE(steady.has_value());
  EXPECT_TRUE(steady->T_previous_current.isApprox(T_found, 1e-6));
  context_.after_gap = true;
  EXPECT_FALSE(predictor.meanVelocityPrior(frame, context_).has_value());
}

TEST_F(MotionPredictorTest, ItsStateCanBeSaved)
{
  MotionPredictor predictor = started(8);
  learnRate(predictor);
  StateArchive saved;
  saved(predictor);
  MotionPredictor other = started(8);
  StateArchive loaded(saved.bytes());
  loaded(other);
  loaded.requireEnd();
  const double stamp = stamp_;
  const Frame frame = next(predictor, sensor_period);
  stamp_ = stamp;
  const Frame again = next(other, sensor_period);
  EXPECT_EQ(again.dt, frame.dt);
  EXPECT_EQ(again.prior.reliable, frame.prior.reliable);
  EXPECT_EQ(again.prior.information, frame.prior.information);
  EXPECT_EQ(again.prior.T_previous_current.matrix(), frame.prior.T_previous_current.matrix());
}
}  // namespace
}  // namespace dyslam
