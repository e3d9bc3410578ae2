// SPDX-License-Identifier: BSD-3-Clause
// Positions of a satellite receiver: where the map is on the earth, and a trajectory without drift.
#include <dyslam/backend/Backend.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "ResumedRun.h"

namespace dyslam
{
namespace
{
const GeodeticPosition place{49, 8.4, 115};
const Eigen::Vector3d antenna(0.3, -0.2, 1);

/** A drive of 400 m along a wide curve, whose odometry turns too far, with a position each second.
 */
struct DriveWithFixes
{
  std::vector<Frame> frames;
  std::vector<Pose> truth;  //!< east-north-up of `place`
  Pose T_enu_map = Pose::Identity();

  explicit DriveWithFixes(double noise, double metres = 400, double turn = 1e-4)
  {
    std::mt19937 rng(7);
    std::normal_distribution<double> normal;
    constexpr double radius = 150;
    constexpr double step_length = 0.8;
    Pose T_odom_vehicle = Pose::Identity();
    for (std::size_t i = 0; step_length * static_cast<double>(i) < metres; ++i)
    {
      const double angle = step_length * static_cast<double>(i) / radius;
      truth.push_back(poseFromYpr(20 + radius * std::cos(angle), -40 + radius * std::sin(angle),
                                  3 + 2 * std::sin(angle), angle + M_PI / 2, 0, 0));
      Frame frame;
      frame.index = i;
      frame.scan.stamp = 100 + 0.1 * static_cast<double>(i);
      if (i > 0)
      {
        const Pose step = truth[i - 1].inverse() * truth[i] * poseFromYpr(0, 0, 0, turn, 0, 0);
        T_odom_vehicle = T_odom_vehicle * step;
        frame.motion.T_previous_current = step;
      }
      Vector6 sigmas;
      sigmas << 0.005, 0.005, 0.005, 0.0003, 0.0003, 0.0003;
      frame.motion.status = MotionStatus::converged;
      frame.motion.information = sigmas.array().square().inverse().matrix().asDiagonal();
      frame.T_odom_vehicle = T_odom_vehicle;
      if (i % 10 == 5)
      {
        Eigen::Vector3d error;
        for (double& value : error)
        {
          value = noise * normal(rng);
        }
        GnssFix fix;
        // Between two scans.
        fix.stamp = frame.scan.stamp - 0.05;
        const Pose half = truth[i - 1] * expSE3(0.5 * logSE3(truth[i - 1].inverse() * truth[i]));
        fix.position = fromEnu(half * antenna + error, place);
        fix.horizontal_sigma = std::max(0.05, noise);
        fix.vertical_sigma = fix.horizontal_sigma;
        fix.antenna = antenna;
        frame.gnss.push_back(fix);
      }
      frames.push_back(std::move(frame));
    }
    T_enu_map = truth.front();
  }
};

struct GnssRun
{
  KeyframeStore keyframes;
  Backend backend;

  GnssRun(DriveWithFixes& drive, const GnssOptions& options) : backend(configOf(options), keyframes)
  {
    for (Frame& frame : drive.frames)
    {
      backend.addFrame(frame);
    }
    backend.finish();
  }
  static BackendConfig configOf(const GnssOptions& options)
  {
    BackendConfig config;
    config.gnss = options;
    return config;
  }
  /** Of the last pose, in the map [m]. */
  [[nodiscard]] double endError(const DriveWithFixes& drive) const
  {
    const Trajectory trajectory = backend.optimisedTrajectory();
    return (drive.T_enu_map.inverse() * drive.truth.back().translation() -
            trajectory[trajectory.size() - 1].pose.translation())
        .norm();
  }
  /** Of a point of the map, placed on the earth [m]. */
  [[nodiscard]] double placeError(const DriveWithFixes& drive, const Eigen::Vector3d& in_map) const
  {
    const auto& found = backend.georeference();
    const Eigen::Vector3d on_earth =
        toEnu(fromEnu(found->T_enu_map * in_map, found->origin), place);
    return (on_earth - drive.T_enu_map * in_map).norm();
  }
  /** Of the last pose, where the georeference places it on the earth [m]. */
  [[nodiscard]] double endOnEarthError(const DriveWithFixes& drive) const
  {
    const Trajectory trajectory = backend.optimisedTrajectory();
    const auto& found = *backend.georeference();
    const Eigen::Vector3d end =
        found.T_enu_map * trajectory[trajectory.size() - 1].pose.translation();
    return (toEnu(fromEnu(end, found.origin), place) - drive.truth.back().translation()).norm();
  }
  [[nodiscard]] std::string warnings() const
  {
    std::string all;
    for (const std::string& warning : backend.warnings())
    {
      all += warning + "\n";
    }
    return all;
  }
};

std::vector<std::array<double, pose_block_size>> posesOf(const Backend& backend)
{
  std::vector<std::array<double, pose_block_size>> poses;
  for (const auto& [key, variable] : backend.factorGraph().variables())
  {
    poses.push_back(variable.block);
  }
  return poses;
}

GnssOptions with(GnssUse use)
{
  GnssOptions options;
  options.use = use;
  return options;
}
}  // namespace

TEST(Gnss, ExactPositionsPlaceTheMap)
{
  DriveWithFixes drive(0, 400, 0);
  for (const GnssUse use : {GnssUse::align, GnssUse::fuse})
  {
    const GnssRun run(drive, with(use));
    ASSERT_TRUE(run.backend.georeference()) << run.warnings();
    EXPECT_LT(run.placeError(drive, {0, 0, 0}), 0.02);
    EXPECT_LT(run.placeError(drive, {-100, 80, 5}), 0.1);
    EXPECT_LT(run.backend.georeference()->horizontal_rmse, 0.02);
    EXPECT_EQ(run.backend.georeference()->fused, use == GnssUse::fuse);
    EXPECT_EQ(run.backend.factorGraph().contains(Key::georeference()), use == GnssUse::fuse);
  }
}

TEST(Gnss, FusedPositionsRemoveTheDrift)
{
  DriveWithFixes drive(0.5);
  const GnssRun off(drive, with(GnssUse::off));
  const GnssRun aligned(drive, with(GnssUse::align));
  EXPECT_FALSE(off.backend.georeference());
  EXPECT_GT(off.endError(drive), 6);
  EXPECT_NEAR(aligned.endError(drive), off.endError(drive), 1e-6);

  const GnssRun fused(drive, with(GnssUse::fuse));
  ASSERT_TRUE(fused.backend.georeference()) << fused.warnings();
  EXPECT_LT(fused.endOnEarthError(drive), 0.3 * off.endError(drive));
  EXPECT_LT(fused.backend.georeference()->horizontal_rmse, 1.5);

  GnssOptions white = with(GnssUse::fuse);  // as the errors are here
  white.correlation_time = 0;
  const GnssRun closer(drive, white);
  ASSERT_TRUE(closer.backend.georeference()) << closer.warnings();
  EXPECT_LT(closer.endOnEarthError(drive), 1);
  std::printf(
      "end: %.2f m off by odometry, on the earth %.2f m when fused, %.2f m with white "
      "errors\n",
      off.endError(drive), fused.endOnEarthError(drive), closer.endOnEarthError(drive));
}

/** The odometry claims 0.4 deg over the way. */
TEST(Gnss, ATrajectoryThatDriftsBeyondItsCovarianceIsCorrectedInPart)
{
  DriveWithFixes drive(0.5, 400, 1e-3);  // 29 deg on the way
  const GnssRun off(drive, with(GnssUse::off));
  const GnssRun fused(drive, with(GnssUse::fuse));
  EXPECT_GT(off.endError(drive), 50);
  ASSERT_TRUE(fused.backend.georeference()) << fused.warnings();
  EXPECT_LT(fused.endOnEarthError(drive), 0.4 * off.endError(drive));
  std::printf("end: %.1f m off by odometry, on the earth %.1f m when fused\n", off.endError(drive),
              fused.endOnEarthError(drive));
}

TEST(Gnss, WrongPositionsDoNotCount)
{
  DriveWithFixes drive(0.3, 400, 0);
  std::size_t seen = 0;
  for (Frame& frame : drive.frames)
  {
    for (GnssFix& fix : frame.gnss)
    {
      if (++seen % 5 == 0)
      {
        fix.position = fromEnu(toEnu(fix.position, place) + Eigen::Vector3d(60, 25, -30), place);
      }
    }
  }
  const GnssRun run(drive, with(GnssUse::fuse));
  ASSERT_TRUE(run.backend.georeference()) << run.warnings();
  EXPECT_LT(run.placeError(drive, {0, 0, 0}), 1.5);
  EXPECT_LT(run.endError(drive), 1.5);
  EXPECT_EQ(run.backend.georeference()->fixes, seen - seen / 5);
  EXPECT_LT(run.backend.georeference()->horizontal_rmse, 1);  // of the others
  EXPECT_NE(run.warnings().find(std::to_string(seen / 5) + " of " + std::to_string(seen) +
                                " positions of the satellite receiver jump"),
            std::string::npos)
      << run.warnings();

  GnssOptions all = with(GnssUse::fuse);
  all.drift = 0;
  const GnssRun with_all(drive, all);
  ASSERT_TRUE(with_all.backend.georeference()) << with_all.warnings();
  EXPECT_EQ(with_all.warnings(), "");
  EXPECT_LT(with_all.placeError(drive, {0, 0, 0}), 1.5);  // by the robust loss
  EXPECT_GT(with_all.backend.georeference()->horizontal_rmse, 5);
}

/** Adds an error to the positions of some frames [m]. */
void shift(std::size_t begin, std::size_t end, const Eigen::Vector3d& error, DriveWithFixes& drive)
{
  for (std::size_t i = begin; i < end; ++i)
  {
    for (GnssFix& fix : drive.frames.at(i).gnss)
    {
      fix.position = fromEnu(toEnu(fix.position, place) + error, place);
    }
  }
}

/** In a tunnel or between buildings many positions in a row have about the same error, and the
 * receiver does not state it. */
TEST(Gnss, APartOfTheDriveWithWrongPositionsDoesNotCount)
{
  constexpr double metres = 1600;
  DriveWithFixes clean(0.5, metres, 0);
  const std::size_t scans = clean.frames.size();
  const double clean_error = GnssRun(clean, with(GnssUse::fuse)).endOnEarthError(clean);
  const Eigen::Vector3d far(40, 25, -10);
  const Eigen::Vector3d near(8, 5, -5);
  for (const auto& [begin, end, error] :
       {std::tuple(scans * 4 / 10, scans * 6 / 10, far),
        std::tuple(scans * 4 / 10, scans * 6 / 10, near), std::tuple(scans * 8 / 10, scans, far),
        std::tuple(std::size_t{0}, scans * 2 / 10, far)})
  {
    DriveWithFixes drive(0.5, metres, 0);
    shift(begin, end, error, drive);
    const GnssRun run(drive, with(GnssUse::fuse));
    ASSERT_TRUE(run.backend.georeference()) << run.warnings();
    EXPECT_NEAR(static_cast<double>(run.backend.georeference()->fixes), 160, 2);
    EXPECT_LT(run.endOnEarthError(drive), clean_error + 0.5);
    EXPECT_LT(run.placeError(drive, {0, 0, 0}), 0.5);
    EXPECT_NE(run.warnings().find("jump against the trajectory"), std::string::npos);
  }
}

/** In the tunnel the trajectory may have drifted, which the positions after it tell. */
TEST(Gnss, PositionsAfterATunnelAreNotLeftOut)
{
  DriveWithFixes drive(0.5, 1600, 0);
  const std::size_t scans = drive.frames.size();
  for (std::size_t i = scans / 2; i < scans * 8 / 10; ++i)
  {
    drive.frames[i].gnss.clear();
  }
  shift(scans * 8 / 10, scans, {20, 12, 0}, drive);
  const GnssRun run(drive, with(GnssUse::align));
  EXPECT_EQ(run.warnings().find("jump against the trajectory"), std::string::npos)
      << run.warnings();
  ASSERT_TRUE(run.backend.georeference()) << run.warnings();
  EXPECT_NEAR(static_cast<double>(run.backend.georeference()->fixes), 140, 3);
}

/** The positions may be right, and the trajectory wrong. */
TEST(Gnss, ALongPartThatDiffersIsNotLeftOut)
{
  DriveWithFixes drive(0.3, 400, 0);
  shift(300, 500, {15, 5, 0}, drive);
  const GnssRun run(drive, with(GnssUse::fuse));
  EXPECT_EQ(run.warnings().find("jump against the trajectory"), std::string::npos);
}

/** In a tunnel or before its first lock a receiver states an accuracy of kilometres. */
TEST(Gnss, SomeInaccuratePositionsDoNotPreventTheUseOfTheOthers)
{
  DriveWithFixes drive(0.3, 400, 0);
  std::size_t seen = 0;
  for (Frame& frame : drive.frames)
  {
    for (GnssFix& fix : frame.gnss)
    {
      if (++seen % 5 == 0)
      {
        fix.position = fromEnu(toEnu(fix.position, place) + Eigen::Vector3d(600, 250, -30), place);
        fix.horizontal_sigma = fix.vertical_sigma = 5000;
      }
    }
  }
  const GnssRun run(drive, with(GnssUse::fuse));
  ASSERT_TRUE(run.backend.georeference()) << run.warnings();
  EXPECT_EQ(run.backend.georeference()->fixes, seen) << "with little weight";
  EXPECT_LT(run.placeError(drive, {0, 0, 0}), 1.5);
  EXPECT_LT(run.endError(drive), 1.5);
}

/** As a live program may get them from a receiver without a fix. */
TEST(Gnss, PositionsThatAreNotFiniteAreIgnored)
{
  DriveWithFixes drive(0.3, 400, 0);
  std::size_t seen = 0;
  for (Frame& frame : drive.frames)
  {
    for (GnssFix& fix : frame.gnss)
    {
      switch (seen++ % 5)
      {
        case 0:
          fix.position = {NAN, NAN, NAN};
          break;
        case 1:
          fix.antenna.x() = NAN;
          break;
        case 2:
          fix.horizontal_sigma = INFINITY;  // as if it was unknown
          break;
        default:
          break;
      }
    }
  }
  const GnssRun run(drive, with(GnssUse::fuse));
  ASSERT_TRUE(run.backend.georeference()) << run.warnings();
  EXPECT_EQ(run.backend.georeference()->fixes, seen * 3 / 5);
  EXPECT_LT(run.placeError(drive, {0, 0, 0}), 1.5);
}

/** While the vehicle stands for an hour, there are no positions whose errors could average out. */
/** Of a live sensor: the first position behind the step is still by the clock before it. */
TEST(Gnss, AClockThatIsSetBackChangesNothing)
{
  DriveWithFixes drive(0.01);
  const GnssRun before(drive, with(GnssUse::fuse));
  DriveWithFixes set_back(0.01);
  constexpr double step = -20;              // [s]
  constexpr std::size_t first_after = 245;  // has a position
  ASSERT_EQ(set_back.frames.at(first_after).gnss.size(), 1U);
  for (std::size_t i = first_after; i < set_back.frames.size(); ++i)
  {
    Frame& frame = set_back.frames[i];
    frame.scan.stamp += step;
    frame.clock_offset = step;
    for (GnssFix& fix : frame.gnss)
    {
      fix.stamp += i == first_after ? 0 : step;
    }
  }
  const GnssRun after(set_back, with(GnssUse::fuse));
  ASSERT_TRUE(after.backend.georeference()) << after.warnings();
  EXPECT_EQ(after.backend.georeference()->fixes, before.backend.georeference()->fixes);
  EXPECT_NEAR(after.endError(set_back), before.endError(drive), 1e-6);
  EXPECT_EQ(after.backend.optimisedTrajectory()[first_after].stamp,
            set_back.frames[first_after].scan.stamp)
      << "as given";
}

TEST(Gnss, APauseAddsNoInformation)
{
  const auto informationOf = [](DriveWithFixes& drive)
  {
    const GnssRun run(drive, with(GnssUse::fuse));
    EXPECT_TRUE(run.backend.georeference()) << run.warnings();
    const FactorGraph& graph = run.backend.factorGraph();
    return graph.factor(graph.factorsOf(Key::georeference()).front()).information()(0, 0);
  };
  DriveWithFixes through(0.5);
  DriveWithFixes interrupted(0.5);
  for (std::size_t i = 250; i < interrupted.frames.size(); ++i)
  {
    Frame& frame = interrupted.frames[i];
    frame.scan.stamp += 3600;
    for (GnssFix& fix : frame.gnss)
    {
      fix.stamp += 3600;
    }
  }
  EXPECT_LT(informationOf(interrupted), 2 * informationOf(through));
}

TEST(Gnss, PositionsThatCannotBeUsedAreReported)
{
  DriveWithFixes drive_short(0.3, 20);
  const GnssRun too_short(drive_short, with(GnssUse::fuse));
  EXPECT_FALSE(too_short.backend.georeference());
  // Nor does a single position that is far off make it longer.
  DriveWithFixes one_far(0.3, 25);
  GnssFix& first = one_far.frames[5].gnss[0];
  first.position = fromEnu(toEnu(first.position, place) + Eigen::Vector3d(300, 0, 0), place);
  EXPECT_FALSE(GnssRun(one_far, with(GnssUse::fuse)).backend.georeference());
  EXPECT_NE(too_short.warnings().find("m are needed to place the map on the earth"),
            std::string::npos);

  DriveWithFixes drive(0.3, 400, 0);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> anywhere(-500, 500);
  for (Frame& frame : drive.frames)
  {
    for (GnssFix& fix : frame.gnss)
    {
      const double east = anywhere(rng);
      fix.position = fromEnu({east, anywhere(rng), 0}, place);
    }
  }
  const GnssRun off(drive, with(GnssUse::off));
  for (const GnssUse use : {GnssUse::align, GnssUse::fuse})
  {
    const GnssRun random(drive, with(use));
    EXPECT_FALSE(random.backend.georeference());
    EXPECT_NE(random.warnings().find("do not fit the trajectory; is its clock"), std::string::npos);
    EXPECT_EQ(posesOf(random.backend), posesOf(off.backend));  // bit for bit
  }

  DriveWithFixes without(0.3);
  for (Frame& frame : without.frames)
  {
    frame.gnss.clear();
  }
  const GnssRun none(without, with(GnssUse::fuse));
  EXPECT_EQ(none.warnings(), "");
}

TEST(Gnss, SwappedLatitudesAndLongitudesAreReported)
{
  DriveWithFixes drive(0.3);
  for (Frame& frame : drive.frames)
  {
    for (GnssFix& fix : frame.gnss)
    {
      std::swap(fix.position.latitude, fix.position.longitude);
    }
  }
  for (const GnssUse use : {GnssUse::align, GnssUse::fuse})
  {
    const GnssRun run(drive, with(use));
    EXPECT_FALSE(run.backend.georeference());
    EXPECT_NE(run.warnings().find("do not fit the trajectory; they fit with latitude and longitude "
                                  "swapped"),
              std::string::npos)
        << run.warnings();
  }
}

TEST(Gnss, AnAccurateReceiverWithItsAntennaElsewhereIsUsed)
{
  DriveWithFixes drive(0, 400, 0);
  for (Frame& frame : drive.frames)
  {
    for (GnssFix& fix : frame.gnss)
    {
      fix.horizontal_sigma = fix.vertical_sigma = 0.02;
      fix.antenna = Eigen::Vector3d::Zero();  // 1.1 m away
    }
  }
  const GnssRun run(drive, with(GnssUse::fuse));
  ASSERT_TRUE(run.backend.georeference()) << run.warnings();
  EXPECT_LT(run.endError(drive), 1);
}

TEST(Gnss, PositionsAreKeptInTheStateOfARun)
{
  DriveWithFixes drive(0.5);
  const GnssRun whole(drive, with(GnssUse::fuse));
  const test::ResumedRun resumed(GnssRun::configOf(with(GnssUse::fuse)), drive.frames);
  ASSERT_TRUE(resumed.backend.georeference());
  EXPECT_EQ(resumed.backend.georeference()->fixes, whole.backend.georeference()->fixes);
  EXPECT_EQ(posesOf(resumed.backend), posesOf(whole.backend));
}

/** A graph that was written after the fusion is solved again by dyslam-graphslam --optimize. */
/** The z axis of a tilted map that is taken for the vertical. */
TEST(Gnss, AVerticalThatContradictsTheAccelerationsIsReported)
{
  const Pose T_level_tilted = poseFromYpr(0, 0, 0, 0, 0, 10 * M_PI / 180);
  DriveWithFixes drive(0.01);
  for (std::size_t i = 0; i < drive.frames.size(); ++i)
  {
    Frame& frame = drive.frames[i];
    frame.motion.T_previous_current =
        T_level_tilted.inverse() * frame.motion.T_previous_current * T_level_tilted;
    frame.T_odom_vehicle = T_level_tilted.inverse() * frame.T_odom_vehicle * T_level_tilted;
    if (i == 0 || i + 1 == drive.frames.size())
    {
      continue;
    }
    frame.dt = 0.1;
    const Eigen::Vector3d acceleration =
        (drive.truth[i + 1].translation() - 2 * drive.truth[i].translation() +
         drive.truth[i - 1].translation()) /
        (frame.dt * frame.dt);
    ImuSample sample;
    sample.stamp = frame.scan.stamp;
    sample.acceleration = (drive.truth[i] * T_level_tilted).linear().transpose() *
                          (acceleration + Eigen::Vector3d(0, 0, 9.80665));
    frame.imu.push_back(sample);
  }
  BackendConfig config = GnssRun::configOf(with(GnssUse::align));
  config.gnss.tilt_sigma = 2e-4;  // as where the path does not show the tilt
  for (const bool level_map : {false, true})
  {
    config.gravity.level_map = level_map;
    KeyframeStore keyframes;
    Backend backend(config, keyframes);
    for (Frame frame : drive.frames)
    {
      backend.addFrame(frame);
    }
    backend.finish();
    ASSERT_TRUE(backend.gravity());
    ASSERT_TRUE(backend.georeference());
    ASSERT_EQ(backend.warnings().size(), level_map ? 0U : 1U);
    if (!level_map)
    {
      EXPECT_NE(backend.warnings()[0].find("degrees off that of the IMU's accelerations"),
                std::string::npos);
    }
  }
}

TEST(Gnss, AFusedGraphIsAtItsOptimum)
{
  DriveWithFixes drive(0.5);
  const GnssRun run(drive, with(GnssUse::fuse));
  StateArchive saved;
  const_cast<FactorGraph&>(run.backend.factorGraph()).exchangeState(saved);
  FactorGraph graph;
  StateArchive loaded(saved.bytes());
  graph.exchangeState(loaded);
  const double before = graph.chi2();
  const OptimisationResult result = graph.optimise(FactorGraphOptions());
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.final_chi2, before, 1e-3 * before);
}

TEST(Gnss, PositionsWithoutAccuracyHaveThatOfTheOptions)
{
  DriveWithFixes drive(0.5, 400, 0);
  for (Frame& frame : drive.frames)
  {
    for (GnssFix& fix : frame.gnss)
    {
      fix.horizontal_sigma = fix.vertical_sigma = 0;
    }
  }
  const GnssRun run(drive, with(GnssUse::fuse));
  ASSERT_TRUE(run.backend.georeference()) << run.warnings();
  EXPECT_LT(run.placeError(drive, {0, 0, 0}), 1);
}
}  // namespace dyslam
