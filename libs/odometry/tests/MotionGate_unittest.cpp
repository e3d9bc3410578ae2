// SPDX-License-Identifier: BSD-3-Clause
#include "motion/MotionGate.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
constexpr double gate_prior_sigma = 0.1;  // [m]

Pose forward(double distance)
{
  return poseFromYpr(distance, 0, 0, 0, 0, 0);
}

/** 0.5 m forward by the prior, a converged motion of the matcher, and one of the segmenter. */
Frame frameWithMotions(const Pose& of_matcher, const Pose& of_segmenter)
{
  Frame frame;
  frame.dt = 0.1;
  frame.prior.T_previous_current = forward(0.5);
  frame.prior.information = informationFromSigmas(gate_prior_sigma, 0.01);
  frame.odometry.T_previous_current = of_matcher;
  frame.odometry.status = MotionStatus::converged;
  frame.segmenter_motion.emplace();
  frame.segmenter_motion->T_previous_current = of_segmenter;
  frame.static_prior.assign(1, 1.0F);
  return frame;
}

TEST(MotionGate, TheMatchersMotionIsAcceptedNearThePrior)
{
  const MotionGate gate(FusionOptions(), true);
  const FrameContext context;
  Frame frame = frameWithMotions(forward(0.6), Pose::Identity());
  EXPECT_EQ(gate.rejectionReason(frame, context), "");
  frame.odometry.T_previous_current = forward(-0.7);
  EXPECT_EQ(gate.rejectionReason(frame, context), "8.5 sigmas from the prior; the gate is 4.0");
  frame.odometry.status = MotionStatus::not_found;
  frame.odometry.reason = "too few points";
  EXPECT_EQ(gate.rejectionReason(frame, context), "too few points");
}

TEST(MotionGate, AMatcherThatFusesThePriorHasTheTighterGate)
{
  const MotionGate gate(FusionOptions(), true);
  FrameContext context;
  const Frame frame = frameWithMotions(forward(0.7), Pose::Identity());
  EXPECT_EQ(gate.rejectionReason(frame, context), "");
  context.matcher_uses_prior = true;
  EXPECT_EQ(gate.rejectionReason(frame, context), "1.9 sigmas from the prior; the gate is 1.0");
}

TEST(MotionGate, WithoutRegistrationEveryConvergedMotionIsAccepted)
{
  const MotionGate gate(FusionOptions(), false);
  const Frame frame = frameWithMotions(forward(-0.7), Pose::Identity());
  EXPECT_EQ(gate.rejectionReason(frame, FrameContext()), "");
}

TEST(MotionGate, TheFirstRegistrationStartsFromTheSegmentersMotion)
{
  const MotionGate gate(FusionOptions(), true);
  FrameContext context;
  context.starts_map = true;
  const Frame frame = frameWithMotions(forward(0.5), Pose::Identity());
  EXPECT_EQ(gate.rejectionReason(frame, context), "");
  context.segmenter_information = gate.segmenterInformation();
  EXPECT_NE(gate.rejectionReason(frame, context), "");
  context.starts_map = false;
  EXPECT_EQ(gate.rejectionReason(frame, context), "");
}

TEST(MotionGate, TheSegmentersMotionIsAcceptedWithAnAppearancePriorNearThePrior)
{
  const MotionGate gate(FusionOptions(), true);
  const Frame good = frameWithMotions(Pose::Identity(), forward(0.6));
  EXPECT_TRUE(gate.acceptsSegmenterMotion(good, Pose::Identity()));
  EXPECT_FALSE(gate.acceptsSegmenterMotion(good, forward(1))) << "deskewed by different motions";
  Frame bad = good;
  bad.segmenter_motion->T_previous_current = forward(2);
  EXPECT_FALSE(gate.acceptsSegmenterMotion(bad, Pose::Identity())) << "far from the prior";
  bad = good;
  bad.static_prior.clear();
  EXPECT_FALSE(gate.acceptsSegmenterMotion(bad, Pose::Identity()));
  bad = good;
  bad.segmenter_motion.reset();
  EXPECT_FALSE(gate.acceptsSegmenterMotion(bad, Pose::Identity()));
  bad = good;
  bad.dt = 0;
  EXPECT_FALSE(gate.acceptsSegmenterMotion(bad, Pose::Identity()));
}

TEST(MotionGate, TheSegmenterMeasuresOnlyTheMotionInThePlane)
{
  const Matrix6 information = MotionGate(FusionOptions(), true).segmenterInformation();
  for (const Eigen::Index i : {0, 1, 5})
  {
    EXPECT_GT(information(i, i), 0);
  }
  for (const Eigen::Index i : {2, 3, 4})
  {
    EXPECT_EQ(information(i, i), 0);
  }
}

TEST(MotionGate, TheInitialGuessIsTheAcceptedMotion)
{
  FusionOptions options;
  options.matcher_sigma = gate_prior_sigma;
  const MotionGate gate(options, true);
  FrameContext context;
  Frame frame = frameWithMotions(forward(0.7), Pose::Identity());
  EXPECT_NEAR(gate.initialGuess(frame, context).translation().x(), 0.5, 1e-9) << "rejected";
  frame.odometry_accepted = true;
  EXPECT_NEAR(gate.initialGuess(frame, context).translation().x(), 0.7, 1e-9);
  context.matcher_uses_prior = true;
  EXPECT_NEAR(gate.initialGuess(frame, context).translation().x(), 0.6, 1e-6) << "as certain";
}

TEST(MotionGate, AcceptedMotionsNarrowTheFirstRegistration)
{
  const FusionOptions options;
  const MotionGate gate(options, true);
  FrameContext context;
  Frame frame = frameWithMotions(forward(0.5), Pose::Identity());
  frame.odometry_accepted = true;
  EXPECT_EQ(gate.initialSigma(frame, context, 2), 2);
  context.segmenter_information = gate.segmenterInformation();
  EXPECT_EQ(gate.initialSigma(frame, context, 2), options.segmenter_initial_sigma);
  context.matcher_uses_prior = true;
  EXPECT_EQ(gate.initialSigma(frame, context, 2), options.matcher_initial_sigma);
  EXPECT_EQ(gate.initialSigma(frame, context, 0.01), 0.01);
}
}  // namespace
}  // namespace dyslam
