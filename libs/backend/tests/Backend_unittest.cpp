// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/PoseInformation.h>
#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "BoxWorld.h"
#include "DriftingFrames.h"

namespace dyslam
{
namespace
{
using test::BoxWorld;
using test::driveAround;

struct Drive
{
  std::vector<Frame> frames;
  std::vector<Pose> truth;
};

/** Frames whose odometry over-estimates heading change and length of every step. */
Drive makeDrive(const BoxWorld& world, std::vector<Pose> truth, double turn, double stretch)
{
  Drive drive;
  drive.truth = std::move(truth);
  drive.frames = test::driftingFrames(world, drive.truth, stretch, turn, 1e6);
  return drive;
}

/** Position error over all frames, both trajectories starting at the same pose [m]. */
double rmsError(const Trajectory& estimate, const std::vector<Pose>& truth)
{
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    const Pose expected = truth.front().inverse() * truth[i];
    const Pose got = estimate[0].pose.inverse() * estimate[i].pose;
    sum += (expected.translation() - got.translation()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

/** A backend and its keyframes. */
struct BackendRun
{
  explicit BackendRun(const BackendOptions& options = {}) : backend(configOf(options), keyframes) {}
  BackendRun(Drive& drive, const BackendOptions& options = {}) : BackendRun(options)
  {
    for (Frame& frame : drive.frames)
    {
      backend.addFrame(frame);
    }
    backend.finish();
  }

  static BackendConfig configOf(const BackendOptions& options)
  {
    BackendConfig config;
    config.backend = options;
    return config;
  }

  KeyframeStore keyframes;
  Backend backend;
};

TEST(Backend, LoopsLowerTheTrajectoryError)
{
  const BoxWorld world(21, 30, 20);
  Drive drive = makeDrive(world, driveAround(30, 20, 280, 0.75), 0.0008, 0.01);
  BackendOptions odometry;
  odometry.mode = BackendMode::odometry;
  const BackendRun without(drive, odometry);
  const double before = rmsError(without.backend.optimisedTrajectory(), drive.truth);
  EXPECT_TRUE(without.backend.loops().empty());
  EXPECT_EQ(without.keyframes.revision(), 0U);

  const BackendRun with(drive);
  const Backend& backend = with.backend;
  const KeyframeStore& keyframes = with.keyframes;
  const double after = rmsError(backend.optimisedTrajectory(), drive.truth);
  RecordProperty("rms_before", std::to_string(before));
  RecordProperty("rms_after", std::to_string(after));
  const auto accepted =
      std::count_if(backend.loops().begin(), backend.loops().end(),
                    [](const Loop& loop) { return loop.verdict == LoopVerdict::accepted; });
  std::printf("position RMS %.3f m by odometry, %.3f m with %td loops, %zu optimisations\n", before,
              after, accepted, keyframes.revision());
  EXPECT_GT(before, 2);
  EXPECT_LT(after, 0.35 * before);
  EXPECT_GT(keyframes.revision(), 0U);
  EXPECT_TRUE(backend.lastOptimisation().converged);

  // Frames, keyframes and graph agree.
  const Trajectory trajectory = backend.optimisedTrajectory();
  ASSERT_EQ(trajectory.size(), drive.frames.size());
  const PoseGraph graph = backend.graph();
  ASSERT_EQ(graph.nodes.size(), keyframes.size());
  EXPECT_EQ(graph.edges.size(), keyframes.size() - 1 + static_cast<std::size_t>(accepted));
  std::size_t marked = 0;
  for (const Frame& frame : drive.frames)
  {
    marked += frame.is_keyframe ? 1 : 0;
  }
  EXPECT_EQ(marked, keyframes.size());
  for (std::size_t k = 0; k < keyframes.size(); ++k)
  {
    const Keyframe& keyframe = keyframes[k];
    EXPECT_TRUE(drive.frames[keyframe.frame].is_keyframe);
    EXPECT_EQ(trajectory[keyframe.frame].stamp, keyframe.stamp);
    EXPECT_TRUE(trajectory[keyframe.frame].pose.isApprox(keyframe.T_map_vehicle, 1e-9));
    EXPECT_GT(keyframes.loopCloud(k).size(), 100U);
  }
  // Online, the last frame already stood where loops put it.
  EXPECT_LT((drive.frames.back().T_map_vehicle().translation() -
             trajectory[trajectory.size() - 1].pose.translation())
                .norm(),
            0.3);
}

TEST(Backend, TwoRunsGiveTheSameBytes)
{
  const BoxWorld world(22, 20, 15);
  Drive drive = makeDrive(world, driveAround(20, 15, 170, 0.75), 0.001, 0.01);
  const Trajectory a = BackendRun(drive).backend.optimisedTrajectory();
  const Trajectory b = BackendRun(drive).backend.optimisedTrajectory();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    EXPECT_EQ(a[i].pose.matrix(), b[i].pose.matrix());
  }
}

TEST(Backend, EdgesCarryTheComposedMotionAndCovariance)
{
  // Two steps of known information between keyframes; the sum checked by sampling.
  BackendOptions options;
  options.keyframe_distance = 1.9;
  options.keyframe_angle = 1;
  BackendRun run(options);
  const Pose step = poseFromYpr(1, 0.1, 0, 0.3, 0, 0);
  Vector6 sigma;
  sigma << 0.02, 0.01, 0.03, 0.004, 0.005, 0.01;
  for (std::size_t i = 0; i < 3; ++i)
  {
    Frame frame;
    frame.index = i;
    frame.scan.stamp = static_cast<double>(i);
    frame.motion.status = MotionStatus::converged;
    frame.motion.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
    frame.T_odom_vehicle = i == 0 ? Pose::Identity() : i == 1 ? step : step * step;
    run.backend.addFrame(frame);
    EXPECT_EQ(frame.is_keyframe, i != 1);
  }
  const PoseGraph graph = run.backend.graph();
  ASSERT_EQ(graph.edges.size(), 1U);
  const auto& edge = graph.edges.begin()->second;
  const Matrix6 information = informationFromYpr(step * step, edge.cov_inv.asEigen());

  std::mt19937 rng(1);
  std::normal_distribution<double> n;
  Matrix6 covariance = Matrix6::Zero();
  constexpr int samples = 40000;
  for (int k = 0; k < samples; ++k)
  {
    const Vector6 x = Vector6::NullaryExpr([&] { return n(rng); }).cwiseProduct(sigma);
    const Vector6 y = Vector6::NullaryExpr([&] { return n(rng); }).cwiseProduct(sigma);
    const Vector6 e = logSE3((step * step).inverse() * step * expSE3(x) * step * expSE3(y));
    covariance += e * e.transpose() / samples;
  }
  const Matrix6 product = information * covariance;
  EXPECT_LT((product - Matrix6::Identity()).cwiseAbs().maxCoeff(), 0.06) << product;
}

TEST(Backend, UnconvergedOdometryOrInvalidInformationMeansLittleTrust)
{
  const double own[4] = {1e8, 1e8, NAN, 0.01};
  const MotionStatus status[4] = {MotionStatus::converged, MotionStatus::not_found,
                                  MotionStatus::converged, MotionStatus::not_settled};
  double information[4] = {0, 0, 0, 0};
  for (int kind = 0; kind < 4; ++kind)
  {
    BackendRun run;
    for (std::size_t i = 0; i < 2; ++i)
    {
      Frame frame;
      frame.index = i;
      frame.motion.status = status[kind];
      frame.motion.information = own[kind] * Matrix6::Identity();
      frame.T_odom_vehicle = poseFromYpr(2.0 * static_cast<double>(i), 0, 0, 0, 0, 0);
      run.backend.addFrame(frame);
    }
    information[kind] = run.backend.graph().edges.begin()->second.cov_inv(0, 0);
  }
  EXPECT_NEAR(information[0], 1 / (1e-8 + 1e-12), 1);
  const double fallback = BackendOptions().unconverged_sigma;
  EXPECT_NEAR(information[1], 1 / (fallback * fallback), 0.01);
  EXPECT_NEAR(information[2], 1 / (fallback * fallback), 0.01);
  EXPECT_NEAR(information[3], 1 / (fallback * fallback + 1 / own[3]), 1e-4)
      << "not settled, or after a gap";
}

/** As by a registration along a corridor of exact planes: one direction is known to rounding errors
 * only. */
TEST(Backend, ADirectionThatIsNearlyUnknownEndsNoRun)
{
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  BackendRun run;
  for (std::size_t i = 0; i < 60; ++i)
  {
    Matrix6 random;
    for (Eigen::Index k = 0; k < random.size(); ++k)
    {
      random.data()[k] = normal(generator);
    }
    const Matrix6 axes = random.householderQr().householderQ();
    Vector6 information = Vector6::Constant(1e7);
    information[5] = 1e-9;
    Frame frame;
    frame.index = i;
    frame.scan.stamp = 0.1 * static_cast<double>(i);
    frame.motion.status = MotionStatus::converged;
    frame.motion.information = axes * information.asDiagonal() * axes.transpose();
    frame.motion.information =
        0.5 * (frame.motion.information + frame.motion.information.transpose()).eval();
    frame.T_odom_vehicle = poseFromYpr(2.0 * static_cast<double>(i), 0, 0, 0, 0, 0);
    run.backend.addFrame(frame);
  }
  run.backend.finish();
  EXPECT_EQ(run.backend.graph().edges.size(), 59U);
}

TEST(Backend, ScansThatWereNotRegisteredMakeNoLoops)
{
  const BoxWorld world(21, 30, 20);
  Drive drive = makeDrive(world, driveAround(30, 20, 250, 0.75), 0.0008, 0.01);
  for (std::size_t i = 16; i < 32; ++i)
  {
    drive.frames[i].motion.status = MotionStatus::not_found;
  }
  const BackendRun run(drive);
  std::size_t accepted = 0;
  for (const Loop& loop : run.backend.loops())
  {
    if (loop.verdict == LoopVerdict::accepted)
    {
      const std::size_t frame = run.keyframes[loop.from].frame;
      EXPECT_TRUE(frame < 16 || frame >= 32) << frame;
      ++accepted;
    }
  }
  EXPECT_GT(accepted, 5U);
}

TEST(Backend, StandingStillIsNoPath)
{
  std::mt19937 rng(1);
  std::normal_distribution<double> jitter(0, 0.0007);
  BackendRun run;
  for (std::size_t i = 0; i < 5000; ++i)
  {
    Frame frame;
    frame.index = i;
    frame.motion.status = MotionStatus::converged;
    frame.motion.information = 1e6 * Matrix6::Identity();
    const double x = i < 4000 ? 0 : 0.01 * static_cast<double>(i - 4000);
    frame.T_odom_vehicle = poseFromYpr(x + jitter(rng), jitter(rng), jitter(rng), 0, 0, 0);
    run.backend.addFrame(frame);
  }
  ASSERT_GT(run.keyframes.size(), 5U);
  const Keyframe& last = run.keyframes.back();
  EXPECT_NEAR(last.path_length, last.T_map_vehicle.translation().x(), 0.12);
}

/** Ten metres a second, but for scans that are not registered. */
TEST(Backend, WhatMayHaveBeenDrivenUnseenIsCounted)
{
  struct Step
  {
    double dt;
    bool registered;
    bool restarted;
    double unseen;  // expected after it
  };
  const std::vector<Step> steps = {
      {0.1, true, false, 0},    {0.1, false, false, 0},    {0.1, true, false, 0},
      {5.0, true, false, 0},    {20.0, false, false, 200}, {0.1, false, false, 200},
      {0.1, false, true, 210},  {0.1, true, false, 210},   {1.0, false, false, 210},
      {1.0, false, false, 210}, {0.1, false, true, 231},   {0.1, true, false, 231}};
  BackendOptions options;
  options.keyframe_distance = 0.5;
  BackendRun run(options);
  Frame first;
  run.backend.addFrame(first);
  double x = 0;
  for (const Step& step : steps)
  {
    Frame frame;
    frame.index = run.keyframes.size();
    frame.dt = step.dt;
    frame.sweep_duration = 0.1;
    frame.motion.status = step.registered ? MotionStatus::converged : MotionStatus::not_found;
    frame.motion.map_restarted = step.restarted;
    x += 10 * std::min(step.dt, 2.0);
    frame.T_odom_vehicle = poseFromYpr(x, 0, 0, 0, 0, 0);
    run.backend.addFrame(frame);
    EXPECT_NEAR(run.keyframes.back().unseen_path, step.unseen, 1e-9) << x;
    EXPECT_NEAR(run.keyframes.back().path_length, x, 1e-9);
  }
}

/** A straight drive past one car that is observed at every scan.
 * \param speed along the drive [m/s] \param interval between scans [s] */
std::vector<Frame> drivePastACar(double speed = 0, double interval = 0.1)
{
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < 30; ++i)
  {
    Frame frame;
    frame.index = i;
    frame.scan.stamp = interval * static_cast<double>(i);
    frame.motion.status = MotionStatus::converged;
    frame.motion.information = 1e6 * Matrix6::Identity();
    frame.T_odom_vehicle = poseFromYpr(static_cast<double>(i), 0, 0, 0, 0, 0);
    TrackedObject car;
    car.id = 3;
    car.object_class = ObjectClass::car;
    car.confirmed = true;
    car.observed = true;
    car.observation.centre = Eigen::Vector3d(20 + speed * frame.scan.stamp, 4, 0);
    car.observation_covariance = 0.01 * Eigen::Matrix4d::Identity();
    frame.objects.push_back(car);
    frames.push_back(frame);
  }
  return frames;
}

/** Runs them with objects; \return the warnings, joined. */
std::string warningsOf(std::vector<Frame> frames, std::vector<SmoothedObject>& smoothed)
{
  BackendOptions options;
  options.mode = BackendMode::full;
  options.keyframe_distance = 0.9;
  BackendRun run(options);
  for (Frame& frame : frames)
  {
    run.backend.addOdometry(frame);
    run.backend.optimise(frame);
  }
  run.backend.finish();
  for (std::size_t i = 0; i < run.keyframes.size(); ++i)
  {
    EXPECT_LT(
        (run.keyframes[i].T_map_vehicle.translation() - frames[i].T_odom_vehicle.translation())
            .norm(),
        1e-3);
  }
  smoothed = run.backend.smoothedObjects();
  std::string joined;
  for (const std::string& warning : run.backend.warnings())
  {
    joined += warning + "\n";
  }
  return joined;
}

TEST(Backend, BadObservationsOfObjectsAreReportedAndTheRestGoesOn)
{
  std::vector<SmoothedObject> smoothed;
  EXPECT_EQ(warningsOf(drivePastACar(), smoothed), "");
  EXPECT_EQ(smoothed.size(), 30U);

  std::vector<Frame> frames = drivePastACar();
  frames[10].objects[0].observation.centre.x() = NAN;
  frames[20].objects[0].observation_covariance.setZero();
  frames[25].objects[0].observation_covariance(1, 1) = NAN;
  std::string warnings = warningsOf(frames, smoothed);
  EXPECT_EQ(warnings.find("3 observations of objects left out of the graph: no finite position"),
            0U)
      << warnings;
  EXPECT_EQ(smoothed.size(), 27U);

  frames = drivePastACar();
  for (std::size_t i = 20; i < frames.size(); ++i)
  {
    frames[i].objects[0].observation.centre.x() += 15;
  }
  warnings = warningsOf(frames, smoothed);
  EXPECT_EQ(warnings,
            "3 observations of objects not linked with earlier ones: more than 3 m from the "
            "expected place (objects.max_jump)\n");
  for (const SmoothedObject& object : smoothed)
  {
    const double x = object.T_map_object.translation().x();
    EXPECT_NEAR(x, object.scan < 20 ? 20 : 35, 0.01) << object.scan;
  }
}

TEST(Backend, EveryVelocityOfAMovingObjectHasACovariance)
{
  constexpr double speed = 8;
  constexpr std::size_t gap = 12;  // longer than objects.max_gap: no motion factor across it
  std::vector<Frame> frames = drivePastACar(speed);
  for (std::size_t i = 14; i < 14 + gap; ++i)
  {
    frames[i].objects.clear();
  }
  std::vector<SmoothedObject> smoothed;
  (void)warningsOf(frames, smoothed);
  ASSERT_EQ(smoothed.size(), frames.size() - gap);
  for (const SmoothedObject& object : smoothed)
  {
    EXPECT_TRUE(object.moving) << object.scan;
    EXPECT_NEAR(object.velocity.x(), speed, 0.1) << object.scan;
    EXPECT_GT(object.velocity_covariance(0, 0), 1e-4) << object.scan;
    EXPECT_LT(object.velocity_covariance(0, 0), 100) << object.scan;
  }
}

/** There are fewer scans within objects.speed_window than the estimate of a speed needs. */
TEST(Backend, ObjectsOfSlowScansAreDynamic)
{
  constexpr double speed = 3;
  for (const double interval : {0.4, 0.5, 1.0})
  {
    std::vector<SmoothedObject> smoothed;
    EXPECT_EQ(warningsOf(drivePastACar(speed, interval), smoothed), "");
    EXPECT_EQ(smoothed.size(), 30U) << interval;
    for (const SmoothedObject& object : smoothed)
    {
      EXPECT_TRUE(object.moving) << interval;
      EXPECT_NEAR(object.velocity.x(), speed, 0.1) << interval;
    }
  }
}

TEST(Backend, EmptyRunAndOneFrame)
{
  BackendRun run;
  Backend& backend = run.backend;
  backend.finish();
  EXPECT_TRUE(backend.optimisedTrajectory().empty());
  EXPECT_TRUE(backend.graph().nodes.empty());
  Frame frame;
  frame.T_odom_vehicle = poseFromYpr(1, 2, 3, 0.5, 0, 0);
  backend.addFrame(frame);
  backend.finish();
  EXPECT_TRUE(frame.is_keyframe);
  EXPECT_EQ(backend.optimisedTrajectory().size(), 1U);
  EXPECT_TRUE(backend.optimisedTrajectory()[0].pose.isApprox(frame.T_odom_vehicle, 1e-12));
  EXPECT_TRUE(frame.T_map_odom.isApprox(Pose::Identity(), 1e-12));
}
}  // namespace
}  // namespace dyslam
