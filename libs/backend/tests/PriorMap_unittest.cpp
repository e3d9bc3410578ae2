// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "BoxWorld.h"
#include "LocalisedRun.h"
#include "MergedRuns.h"
#include "ResumedRun.h"

namespace dyslam
{
namespace
{
using test::BoxWorld;
using test::driveAround;
using test::framesOf;
using test::LocalisedRun;
using test::mapOf;
using test::part;
using test::ResumedRun;
using test::T_prior_world;
using test::turnedRound;
using test::withStart;

TEST(Localisation, PutsARunIntoTheFrameOfTheMap)
{
  const BoxWorld world(33, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 150, 0.75);
  const std::vector<Eigen::Vector3f> map = mapOf(world, drive);
  for (const std::vector<Pose>& truth : {part(drive, 30, 150), turnedRound(part(drive, 60, 170))})
  {
    const LocalisedRun run(map, framesOf(world, truth));
    ASSERT_TRUE(run.fit().localised) << run.fit().reason;
    EXPECT_LT(run.error(truth), 0.15);
    EXPECT_LT(run.fit().path_length, 30);
    EXPECT_GE(run.fit().registered, 20U);
    EXPECT_GE(run.fit().registered, 0.9 * static_cast<double>(run.fit().tried));
    EXPECT_LT(run.fit().rmse, 0.1);
    EXPECT_EQ(run.fit().found_again, 0U);
    // Online, too: the last frame was where it is now.
    const Pose last = T_prior_world * truth.back();
    EXPECT_LT((run.frames.back().T_map_vehicle().translation() - last.translation()).norm(), 0.2);

    const FactorGraph& graph = run.backend.factorGraph();
    EXPECT_TRUE(graph.pose(Key::priorMap()).isApprox(Pose::Identity()));
    EXPECT_EQ(graph.factorsOf(Key::priorMap()).size(), run.fit().registered);
    EXPECT_FALSE(graph.variables().at(Key::ego(0)).fixed);
    EXPECT_TRUE(run.backend.lastOptimisation().warnings.empty());
  }
}

TEST(Localisation, GoesOnByOdometryWhereTheMapEnds)
{
  const BoxWorld world(34, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 160, 0.75);
  const std::vector<Eigen::Vector3f> map = mapOf(world, part(drive, 0, 80));  // 60 of 160 m
  const LocalisedRun run(map, framesOf(world, drive, 0.002, 0.0001));
  ASSERT_TRUE(run.fit().localised) << run.fit().reason;
  EXPECT_LT(run.fit().registered, run.keyframes.size() / 2);
  EXPECT_LT(run.error(part(drive, 0, 80)), 0.15);
  EXPECT_LT(run.error(drive), 1);
}

/** Nothing but the last three fixes says how far the odometry has drifted. */
TEST(Localisation, CorrectsTheDriftOfALongWayBesideTheMap)
{
  FactorGraph graph;
  graph.addPose(Key::priorMap(), Pose::Identity());
  graph.setFixed(Key::priorMap(), true);
  const auto informationOf = [](double sigma, double sigma_rotation)
  {
    Vector6 sigmas;
    sigmas << Eigen::Vector3d::Constant(sigma), Eigen::Vector3d::Constant(sigma_rotation);
    return Matrix6(sigmas.cwiseAbs2().cwiseInverse().asDiagonal());
  };
  constexpr std::size_t keyframes = 200;
  const Pose step = poseFromYpr(1.5, 0, 0, 0.02, 0, 0);
  Pose measured = step;
  measured.translation() *= 1.03;
  Pose truth = Pose::Identity();
  Pose T_map_vehicle = Pose::Identity();
  for (std::size_t k = 0; k < keyframes; ++k)
  {
    graph.addPose(Key::ego(k), T_map_vehicle);
    if (k > 0)
    {
      graph.add(std::make_unique<OdometryFactor>(k - 1, k, measured, informationOf(0.02, 0.002)));
    }
    if (k < 20 || k + 3 >= keyframes)
    {
      graph.add(std::make_unique<LocalisationFactor>(k, truth, informationOf(0.03, 0.002)));
    }
    truth = truth * step;
    T_map_vehicle = T_map_vehicle * measured;
  }
  const Pose T_true = truth * step.inverse();
  const auto error = [&]
  { return (graph.pose(Key::ego(keyframes - 1)).translation() - T_true.translation()).norm(); };
  EXPECT_GT(error(), 4);
  EXPECT_TRUE(graph.optimise(FactorGraphOptions()).converged);
  EXPECT_LT(error(), 0.2);
}

/** The frames as of an odometry that slips, without knowing it, on the way to frame `at`. */
std::vector<Frame> slipped(std::vector<Frame> frames, std::size_t at, const Pose& slip)
{
  frames[at].motion.T_previous_current = frames[at].motion.T_previous_current * slip;
  for (std::size_t i = at; i < frames.size(); ++i)
  {
    frames[i].T_odom_vehicle = frames[i - 1].T_odom_vehicle * frames[i].motion.T_previous_current;
  }
  return frames;
}

/** After the slip no keyframe fits where the odometry predicts it. */
TEST(Localisation, IsFoundAgainAfterTheOdometrySlipped)
{
  const BoxWorld world(41, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 190, 0.75);
  const std::vector<Eigen::Vector3f> map = mapOf(world, drive);
  const std::vector<Pose> truth = part(drive, 10, 220);
  const std::vector<Frame> frames =
      slipped(framesOf(world, truth), 60, poseFromYpr(6, 2, 0, 0.12, 0, 0));
  const LocalisedRun run(map, frames, withStart(truth.front()));
  ASSERT_TRUE(run.fit().localised) << run.fit().reason;
  EXPECT_TRUE(run.fit().reason.empty());
  EXPECT_EQ(run.fit().found_again, 1U);
  EXPECT_LE(run.fit().registered, run.fit().tried);
  EXPECT_EQ(run.fit().registered, run.backend.factorGraph().factorsOf(Key::priorMap()).size());
  const Trajectory trajectory = run.backend.optimisedTrajectory();
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    if (i < 52 || i >= 70)
    {
      const Pose T_true = T_prior_world * truth[i];
      EXPECT_LT((trajectory[i].pose.translation() - T_true.translation()).norm(), 0.3) << i;
    }
  }
  const Pose last = T_prior_world * truth.back();
  EXPECT_LT((run.frames.back().T_map_vehicle().translation() - last.translation()).norm(), 0.3);

  // Resumed at frame 105, when the run is lost or about to be found.
  std::vector<Frame> again = frames;
  const ResumedRun resumed(withStart(truth.front()), again, map);
  const Trajectory other = resumed.backend.optimisedTrajectory();
  ASSERT_EQ(trajectory.size(), other.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i)
  {
    EXPECT_EQ(trajectory[i].pose.matrix(), other[i].pose.matrix());
  }
}

TEST(Localisation, SaysThatTheRunIsTooShort)
{
  const BoxWorld world(40, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 60, 0.75);
  const std::vector<Pose> truth = part(drive, 20, 23);
  const LocalisedRun run(mapOf(world, drive), framesOf(world, truth), withStart(truth.front()));
  EXPECT_FALSE(run.fit().localised);
  EXPECT_EQ(run.fit().reason, "the path since a place was found is too short to confirm it");
}

/** Until it moves there is no path on which fixes could agree, and a place is searched for once. */
TEST(Localisation, AVehicleThatStandsAndTurnsAtFirst)
{
  const BoxWorld world(42, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 90, 0.75);
  std::vector<Pose> truth(20, drive[20]);
  for (int i = 1; i <= 30; ++i)
  {
    truth.push_back(drive[20] * poseFromYpr(0, 0, 0, i * M_PI / 15, 0, 0));
  }
  const std::vector<Pose> moving = part(drive, 20, 90);
  truth.insert(truth.end(), moving.begin(), moving.end());
  std::vector<Frame> frames = framesOf(world, truth);
  KeyframeStore keyframes;
  Backend backend(BackendConfig(), keyframes, mapOf(world, drive));
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    backend.addFrame(frames[i]);
    if (i < 50)
    {
      EXPECT_FALSE(backend.priorMapFit()->localised) << i;
      EXPECT_FALSE(backend.priorMapFit()->reason.empty()) << i;
    }
    if (i == 19)
    {
      EXPECT_EQ(keyframes.size(), 1U);
    }
  }
  backend.finish();
  const PriorMapFit fit = backend.priorMapFit().value();
  ASSERT_TRUE(fit.localised) << fit.reason;
  EXPECT_LT(fit.path_length, 30);
  EXPECT_LE(fit.registered, fit.tried);
  EXPECT_LT(fit.rmse, 0.1);
  const Trajectory trajectory = backend.optimisedTrajectory();
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    const Pose T_true = T_prior_world * truth[i];
    EXPECT_LT((trajectory[i].pose.translation() - T_true.translation()).norm(), 0.2) << i;
  }
}

/** Points of a corridor along x, 8 m wide and 3 m high [m]. The floor ends before the walls. */
std::vector<Eigen::Vector3f> corridor(float begin, float end)
{
  std::vector<Eigen::Vector3f> points;
  for (float x = begin; x <= end; x += 0.4F)
  {
    for (float z = 0; z <= 3; z += 0.4F)
    {
      points.emplace_back(x, -4, z);
      points.emplace_back(x, 4, z);
    }
    for (float y = -2.4F; y < 2.6F; y += 0.4F)
    {
      points.emplace_back(x, y, 0);
    }
  }
  return points;
}

/** Frames along a drive among points that are seen from everywhere within 25 m. The odometry is
 * wrong in the same way at every step: its length by `stretch`, its heading by `turn` [rad]. */
std::vector<Frame> framesAmong(const std::vector<Eigen::Vector3f>& world,
                               const std::vector<Pose>& truth,
                               double stretch,
                               double turn)
{
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    Frame frame;
    frame.index = i;
    frame.scan.stamp = 100 + 0.1 * static_cast<double>(i);
    const Eigen::Isometry3f T_vehicle_world = truth[i].inverse().cast<float>();
    for (const Eigen::Vector3f& point : world)
    {
      const Eigen::Vector3f p = T_vehicle_world * point;
      if (p.head<2>().norm() < 25)
      {
        frame.cloud.points.push_back(p);
      }
    }
    if (i > 0)
    {
      Pose step = truth[i - 1].inverse() * truth[i];
      step.translation() *= 1 + stretch;
      frame.motion.T_previous_current = step * poseFromYpr(0, 0, 0, turn, 0, 0);
      frame.T_odom_vehicle = frames.back().T_odom_vehicle * frame.motion.T_previous_current;
    }
    frame.motion.status = MotionStatus::converged;
    frame.motion.information = 1e4 * Matrix6::Identity();
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<Pose> alongX(std::size_t metres)
{
  std::vector<Pose> poses;
  for (std::size_t i = 0; i <= metres; ++i)
  {
    poses.push_back(poseFromYpr(static_cast<double>(i), 0, 1.7, 0, 0, 0));
  }
  return poses;
}

std::vector<Eigen::Vector3f> inPriorMap(const std::vector<Eigen::Vector3f>& world)
{
  const Eigen::Isometry3f T = T_prior_world.cast<float>();
  std::vector<Eigen::Vector3f> map;
  for (const Eigen::Vector3f& p : world)
  {
    map.emplace_back(T * p);
  }
  return map;
}

TEST(Localisation, SaysThatTheSurfacesDoNotConstrainThePosition)
{
  const std::vector<Eigen::Vector3f> world = corridor(-60, 60);
  const std::vector<Pose> truth = alongX(10);
  const LocalisedRun run(inPriorMap(world), framesAmong(world, truth, 0, 0),
                         withStart(truth.front()));
  EXPECT_FALSE(run.fit().localised);
  EXPECT_EQ(run.fit().reason, "the surfaces do not constrain the position in one direction");
}

/** From a place with structure into a corridor, along which nothing is measured. */
TEST(Localisation, InACorridorOnlyItsDirectionDrifts)
{
  std::vector<Eigen::Vector3f> world = corridor(-60, 160);
  for (int i = -4; i <= 4; ++i)  // walls across, beside the way
  {
    const auto x = 6 * static_cast<float>(i);
    for (float y = 5 + static_cast<float>((i + 4) % 3); y < 12; y += 0.4F)
    {
      for (float z = 0; z <= 3; z += 0.4F)
      {
        world.emplace_back(x, y, z);
        world.emplace_back(x + 2.5F, -y, z);
      }
    }
  }
  const std::vector<Pose> truth = alongX(110);
  const LocalisedRun run(inPriorMap(world), framesAmong(world, truth, 0.01, 0.0005),
                         withStart(truth.front()));
  ASSERT_TRUE(run.fit().localised) << run.fit().reason;
  EXPECT_GE(run.fit().registered, 0.9 * static_cast<double>(run.fit().tried));
  EXPECT_GE(run.fit().tried, 20U) << "one every 4 m";
  const Pose T_true_end = (T_prior_world * truth.back()).inverse() *
                          run.backend.optimisedTrajectory()[truth.size() - 1].pose;
  EXPECT_LT(std::abs(T_true_end.translation().y()), 0.15) << "0.8 m by the odometry since x = 52";
  EXPECT_LT(std::abs(T_true_end.translation().x()), 3);

  const FactorGraph& graph = run.backend.factorGraph();
  const Factor& last = graph.factor(graph.factorsOf(Key::priorMap()).back());
  const Eigen::Matrix3d translation = last.information().topLeftCorner<3, 3>();
  EXPECT_LT(std::abs(translation(0, 0)), 2) << "sigma of 1 m along the corridor";
  EXPECT_GT(translation(1, 1), 100);
}

TEST(Localisation, FailsInAMapOfAnotherPlace)
{
  const std::vector<Pose> drive = driveAround(30, 20, 40, 0.75);
  const std::vector<Eigen::Vector3f> map = mapOf(BoxWorld(35, 30, 20), drive);
  const LocalisedRun run(map, framesOf(BoxWorld(36, 30, 20), drive));
  EXPECT_FALSE(run.fit().localised);
  EXPECT_FALSE(run.fit().reason.empty());
  EXPECT_FALSE(run.backend.factorGraph().contains(Key::priorMap()));
  EXPECT_TRUE(run.backend.optimisedTrajectory()[0].pose.isApprox(Pose::Identity()));
}

TEST(Localisation, ARoughStartTellsPlacesThatLookAlikeApart)
{
  const BoxWorld world = BoxWorld::square(37, 30);
  const std::vector<Pose> drive = driveAround(30, 30, 200, 0.75);
  const std::vector<Eigen::Vector3f> map = mapOf(world, drive);
  const std::vector<Pose> side = part(drive, 70, 125);
  const LocalisedRun anywhere(map, framesOf(world, side));
  EXPECT_FALSE(anywhere.fit().localised);
  EXPECT_EQ(anywhere.fit().reason, "several places of the map fit equally well");

  const Pose rough = side.front() * poseFromYpr(3, -2, 0.5, 0.3, 0, 0);
  const LocalisedRun run(map, framesOf(world, side), withStart(rough));
  ASSERT_TRUE(run.fit().localised) << run.fit().reason;
  EXPECT_LT(run.error(side), 0.15);
}

TEST(Localisation, AResumedRunIsTheSame)
{
  const BoxWorld world(38, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 90, 0.75);
  const std::vector<Eigen::Vector3f> map = mapOf(world, drive);
  const BackendConfig config = withStart(drive[20]);
  const LocalisedRun whole(map, framesOf(world, part(drive, 20, 100)), config);
  ASSERT_TRUE(whole.fit().localised) << whole.fit().reason;
  std::vector<Frame> frames = framesOf(world, part(drive, 20, 100));
  const ResumedRun resumed(config, frames, map);
  const Trajectory a = whole.backend.optimisedTrajectory();
  const Trajectory b = resumed.backend.optimisedTrajectory();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    EXPECT_EQ(a[i].pose.matrix(), b[i].pose.matrix());
  }
  EXPECT_EQ(resumed.backend.priorMapFit()->registered, whole.fit().registered);
}

TEST(Localisation, NeedsAGraphAndAPose)
{
  const std::vector<Eigen::Vector3f> map{{1, 2, 3}};
  KeyframeStore keyframes;
  BackendConfig config;
  EXPECT_FALSE(Backend(config, keyframes).priorMapFit());
  config.backend.mode = BackendMode::odometry;
  EXPECT_THROW(Backend(config, keyframes, map), UserError);
  config = {};
  for (const char* start : {"1 2", "1 2 3 4 5 6 7", "here"})
  {
    config.prior_map.start = start;
    EXPECT_THROW(Backend(config, keyframes, map), UserError) << start;
  }
}
}  // namespace
}  // namespace dyslam
