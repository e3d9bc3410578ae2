// SPDX-License-Identifier: BSD-3-Clause
// Accelerations of an IMU: the vertical in the map frame, and a trajectory whose tilt does not
// drift.
#include <dyslam/backend/Backend.h>
#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "GravityAnchor.h"
#include "ResumedRun.h"

namespace dyslam
{
namespace
{
const Pose T_vehicle_imu = poseFromYpr(1.2, -0.3, 0.4, 0.5, 0.1, -0.2);

/** Pose at a time of a drive along bends and over hills, which begins on a slope, at 5 to 11 m/s.
 */
Pose truthAt(double t)
{
  const double distance = 8 * t + 6 * (1 - std::cos(0.5 * t));
  const double yaw = 0.6 * std::sin(distance / 40);
  const Eigen::Vector3d position(distance, 12 * std::sin(distance / 60),
                                 0.1 * distance + 2 * std::sin(distance / 30));
  return poseFromYpr(position.x(), position.y(), position.z(), yaw,
                     -0.1 - 0.05 * std::cos(distance / 30), 0.02 * std::sin(1.7 * t));
}

/** A drive with IMU whose odometry pitches and rolls by a constant error per metre. */
struct DriveWithImu
{
  std::vector<Frame> frames;
  std::vector<Pose> truth;

  DriveWithImu(double seconds, double drift, const Eigen::Vector3d& bias, double scale = 1)
  {
    std::mt19937 rng(3);
    std::normal_distribution<double> normal;
    Pose T_odom_vehicle = Pose::Identity();
    for (std::size_t i = 0; 0.1 * static_cast<double>(i) < seconds; ++i)
    {
      const double time = 0.1 * static_cast<double>(i);
      truth.push_back(truthAt(time));
      Frame frame;
      frame.index = i;
      frame.scan.stamp = 100 + time;
      if (i > 0)
      {
        frame.dt = frame.scan.stamp - frames.back().scan.stamp;
        const Pose step =
            truth[i - 1].inverse() * truth[i] * poseFromYpr(0, 0, 0, 0, drift, -0.5 * drift);
        T_odom_vehicle = T_odom_vehicle * step;
        frame.motion.T_previous_current = step;
        for (int k = -9; k <= 0; ++k)
        {
          frame.imu.push_back(sampleAt(time + 0.01 * k, bias, scale));
          for (double& value : *frame.imu.back().acceleration)
          {
            value += 0.05 * normal(rng);
          }
        }
      }
      Vector6 sigmas;
      sigmas << 0.005, 0.005, 0.005, 0.0005, 0.0005, 0.0005;
      frame.motion.status = MotionStatus::converged;
      frame.motion.information = sigmas.array().square().inverse().matrix().asDiagonal();
      frame.T_odom_vehicle = T_odom_vehicle;
      frames.push_back(std::move(frame));
    }
  }

  /** \param bias of the accelerometer, vehicle axes \param scale of its unit */
  static ImuSample sampleAt(double time, const Eigen::Vector3d& bias, double scale)
  {
    constexpr double step = 1e-3;
    const auto placeAt = [](double t) -> Eigen::Vector3d
    { return (truthAt(t) * T_vehicle_imu).translation(); };
    const Eigen::Vector3d acceleration =
        (placeAt(time + step) - 2 * placeAt(time) + placeAt(time - step)) / (step * step);
    const Eigen::Vector3d force = acceleration + Eigen::Vector3d(0, 0, 9.80665);
    ImuSample sample;
    sample.stamp = 100 + time;
    sample.T_vehicle_imu = T_vehicle_imu;
    sample.acceleration = scale * (T_vehicle_imu.linear().transpose() *
                                   (truthAt(time).linear().transpose() * force + bias));
    return sample;
  }

  [[nodiscard]] Eigen::Vector3d upMap() const
  {
    return truth.front().linear().transpose() * Eigen::Vector3d::UnitZ();
  }
};

struct GravityRun
{
  KeyframeStore keyframes;
  Backend backend;

  GravityRun(DriveWithImu drive, GravityUse use, bool level_map = false)
      : backend(configOf(use, level_map), keyframes)
  {
    for (Frame& frame : drive.frames)
    {
      backend.addFrame(frame);
    }
    backend.finish();
  }
  static BackendConfig configOf(GravityUse use, bool level_map = false)
  {
    BackendConfig config;
    config.gravity.use = use;
    config.gravity.level_map = level_map;
    return config;
  }
  /** Error of the height of the last pose, in the map [m]. */
  [[nodiscard]] double endError(const DriveWithImu& drive) const
  {
    const Trajectory trajectory = backend.optimisedTrajectory();
    const Eigen::Vector3d end = drive.truth.front().inverse() * drive.truth.back().translation();
    return (trajectory[trajectory.size() - 1].pose.translation() - end).norm();
  }
  [[nodiscard]] double upError(const DriveWithImu& drive) const
  {
    return std::acos(std::min(1.0, backend.gravity()->up_map.dot(drive.upMap())));
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

constexpr double degrees = M_PI / 180;

TEST(Gravity, ExactTrajectoryShowsTheVertical)
{
  const DriveWithImu drive(40, 0, Eigen::Vector3d::Zero());
  for (const GravityUse use : {GravityUse::measure, GravityUse::fuse})
  {
    const GravityRun run(drive, use);
    ASSERT_TRUE(run.backend.gravity()) << run.warnings();
    EXPECT_LT(run.upError(drive), 0.05 * degrees);
    EXPECT_GT(run.backend.gravity()->tilt, 5 * degrees) << "the drive begins on a slope";
    EXPECT_LT(run.backend.gravity()->rmse, 0.1 * degrees);
    EXPECT_EQ(run.backend.gravity()->fused, use == GravityUse::fuse);
    EXPECT_EQ(run.backend.factorGraph().contains(Key::vertical()), use == GravityUse::fuse);
    EXPECT_LT(run.endError(drive), 0.2);
  }
  EXPECT_FALSE(GravityRun(drive, GravityUse::off).backend.gravity());
}

TEST(Gravity, AccelerationsInMultiplesOfGravityAreRecognised)
{
  const DriveWithImu drive(40, 0, Eigen::Vector3d::Zero());
  const DriveWithImu in_g(40, 0, Eigen::Vector3d::Zero(), 1 / 9.80665);
  const GravityRun run(in_g, GravityUse::measure);
  ASSERT_TRUE(run.backend.gravity()) << run.warnings();
  EXPECT_LT(run.upError(drive), 0.2 * degrees) << "its noise is ten times larger";
}

/** The rotation is about a horizontal axis, by the angle between up and z. */
TEST(Gravity, LevellingIsTheLeastRotationThatMakesUpwardsTheZAxis)
{
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  for (const Eigen::Vector3d& up :
       {Eigen::Vector3d(0, 0, 9.8), Eigen::Vector3d(0.3, -0.2, 0.9), Eigen::Vector3d(5, 0, 0),
        Eigen::Vector3d(-0.1, 0.2, -3), Eigen::Vector3d(1e-3, 0, -1), Eigen::Vector3d(0, 0, -2)})
  {
    const Pose T_level_map = levellingOf(up);
    const Eigen::Matrix3d R = T_level_map.linear();
    EXPECT_TRUE((R * up).isApprox(up.norm() * z, 1e-8)) << up.transpose();
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-8)) << up.transpose();
    EXPECT_NEAR(R.determinant(), 1, 1e-8) << up.transpose();
    EXPECT_NEAR(rotationAngle(T_level_map), std::atan2(up.head<2>().norm(), up.z()), 1e-8)
        << up.transpose();
    EXPECT_TRUE(T_level_map.translation().isZero());
  }
}

TEST(Gravity, LevelledMapIsRotatedAsAWhole)
{
  const DriveWithImu drive(40, 0, Eigen::Vector3d::Zero());
  for (const GravityUse use : {GravityUse::measure, GravityUse::fuse})
  {
    const GravityRun as_recorded(drive, use);
    const GravityRun run(drive, use, true);
    ASSERT_TRUE(run.backend.gravity()) << run.warnings();
    EXPECT_TRUE(run.backend.gravity()->levelled);
    EXPECT_EQ(run.backend.gravity()->tilt, as_recorded.backend.gravity()->tilt);
    EXPECT_EQ(run.backend.gravity()->up_map, Eigen::Vector3d::UnitZ());
    const Trajectory before = as_recorded.backend.optimisedTrajectory();
    const Trajectory after = run.backend.optimisedTrajectory();
    const Pose T_level_map = after[0].pose * before[0].pose.inverse();
    EXPECT_NEAR(rotationAngle(T_level_map), run.backend.gravity()->tilt, 1e-4);
    for (std::size_t i = 0; i < before.size(); i += 50)
    {
      EXPECT_TRUE((T_level_map * before[i].pose).isApprox(after[i].pose, 1e-9)) << i;
      EXPECT_NEAR((after[i].pose.linear() *
                   (drive.truth[i].linear().transpose() * Eigen::Vector3d::UnitZ()))
                      .z(),
                  1, 1e-5)
          << i;
    }
    EXPECT_NEAR(run.backend.factorGraph().chi2(), as_recorded.backend.factorGraph().chi2(), 1e-6);
  }
}

/** No factor determines the yaw of the vertical: what the solver leaves there turns no map. */
TEST(Gravity, LevelledMapIsNotTurnedAboutTheVertical)
{
  const DriveWithImu drive(60, 1e-4, {0.08, -0.06, 0.05});
  const GravityRun run(drive, GravityUse::fuse, true);
  ASSERT_TRUE(run.backend.gravity()) << run.warnings();
  const Pose first = run.backend.optimisedTrajectory()[0].pose;  // without levelling: identity
  EXPECT_NEAR(rotationAngle(first), run.backend.gravity()->tilt, 1e-6);
}

TEST(Gravity, FusedDirectionsRemoveTheDriftOfTheTilt)
{
  const DriveWithImu drive(60, 1e-4, {0.08, -0.06, 0.05});  // 3.4 deg in 600 scans
  const GravityRun off(drive, GravityUse::off);
  const GravityRun fused(drive, GravityUse::fuse);
  ASSERT_TRUE(fused.backend.gravity()) << fused.warnings();
  EXPECT_GT(off.endError(drive), 8);
  EXPECT_LT(fused.endError(drive), 0.25 * off.endError(drive));
  EXPECT_LT(fused.upError(drive), 0.6 * degrees) << "the bias, on a drive without turns";
}

TEST(Gravity, AccelerationsThatCannotBeUsedAreReported)
{
  const GravityRun wrong_unit(DriveWithImu(30, 0, Eigen::Vector3d::Zero(), 0.5), GravityUse::fuse);
  EXPECT_FALSE(wrong_unit.backend.gravity());
  EXPECT_NE(wrong_unit.warnings().find("gravity would be 5."), std::string::npos)
      << wrong_unit.warnings();
  EXPECT_FALSE(wrong_unit.backend.factorGraph().contains(Key::vertical()));

  DriveWithImu misplaced(60, 0, Eigen::Vector3d::Zero());  // the IMU looks along changing axes
  for (std::size_t i = 0; i < misplaced.frames.size(); ++i)
  {
    for (ImuSample& sample : misplaced.frames[i].imu)
    {
      sample.T_vehicle_imu =
          poseFromYpr(0, 0, 0, 0, 0.15 * std::sin(0.03 * static_cast<double>(i)), 0) *
          sample.T_vehicle_imu;
    }
  }
  const GravityRun off(misplaced, GravityUse::off);
  const GravityRun refused(misplaced, GravityUse::fuse);
  EXPECT_FALSE(refused.backend.gravity());
  EXPECT_NE(refused.warnings().find("are not used"), std::string::npos) << refused.warnings();
  EXPECT_EQ(refused.endError(misplaced), off.endError(misplaced));

  const DriveWithImu too_short(5, 0, Eigen::Vector3d::Zero());
  EXPECT_FALSE(GravityRun(too_short, GravityUse::fuse).backend.gravity());
}

TEST(Gravity, AccelerationsAreKeptInTheStateOfARun)
{
  DriveWithImu drive(40, 1e-4, {0.05, 0.02, 0});
  const GravityRun whole(drive, GravityUse::fuse);
  const test::ResumedRun resumed(GravityRun::configOf(GravityUse::fuse), drive.frames);
  ASSERT_TRUE(resumed.backend.gravity());
  EXPECT_EQ(resumed.backend.gravity()->up_map, whole.backend.gravity()->up_map);
  EXPECT_EQ(resumed.backend.gravity()->directions, whole.backend.gravity()->directions);
}

/** The same accelerations, each with the frame `frames` later; 1 frame earlier: -1. */
DriveWithImu recordedLater(const DriveWithImu& drive, int frames)
{
  DriveWithImu moved = drive;
  const auto count = static_cast<int>(drive.frames.size());
  for (int i = 0; i < count; ++i)
  {
    std::vector<ImuSample>& samples = moved.frames[static_cast<std::size_t>(i)].imu;
    samples.clear();
    if (i - frames >= 0 && i - frames < count)
    {
      samples = drive.frames[static_cast<std::size_t>(i - frames)].imu;
    }
  }
  return moved;
}

TEST(Gravity, AccelerationsCountByTheirTimeNotByTheirPlaceInTheRecording)
{
  const DriveWithImu drive(40, 1e-4, {0.05, 0.02, 0});
  const GravityRun sorted(drive, GravityUse::fuse);
  ASSERT_TRUE(sorted.backend.gravity()) << sorted.warnings();
  // Scans with the time of their first point are recorded behind the samples of their revolution.
  DriveWithImu before = recordedLater(drive, -1);
  const GravityRun ahead(before, GravityUse::fuse);
  ASSERT_TRUE(ahead.backend.gravity()) << ahead.warnings();
  EXPECT_EQ(ahead.backend.gravity()->directions, sorted.backend.gravity()->directions);
  EXPECT_EQ(ahead.backend.gravity()->up_map, sorted.backend.gravity()->up_map);
  const test::ResumedRun resumed(GravityRun::configOf(GravityUse::fuse), before.frames);
  ASSERT_TRUE(resumed.backend.gravity());
  EXPECT_EQ(resumed.backend.gravity()->up_map, sorted.backend.gravity()->up_map);

  const GravityRun behind(recordedLater(drive, 3), GravityUse::fuse);
  ASSERT_TRUE(behind.backend.gravity()) << behind.warnings();
  EXPECT_GE(behind.backend.gravity()->directions + 1, sorted.backend.gravity()->directions)
      << "the last three frames have none";
  EXPECT_LT(behind.upError(drive), sorted.upError(drive) + 0.1 * degrees);
}

void removeAccelerations(DriveWithImu& drive)
{
  for (Frame& frame : drive.frames)
  {
    for (ImuSample& sample : frame.imu)
    {
      sample.acceleration.reset();
    }
  }
}

TEST(Gravity, AMapThatCannotBeLevelledIsReported)
{
  const auto warningsOf = [](const DriveWithImu& drive, GravityUse use)
  {
    const GravityRun run(drive, use, true);
    EXPECT_FALSE(run.backend.gravity());
    return run.warnings();
  };
  DriveWithImu drive(5, 0, Eigen::Vector3d::Zero());
  EXPECT_EQ(warningsOf(drive, GravityUse::off), "the map is not levelled: gravity.use is off\n");
  EXPECT_EQ(warningsOf(drive, GravityUse::measure),
            "the map is not levelled: 1 of 3 directions of gravity that are needed; each takes "
            "gravity.window (4 s) without a gap, and 8 scans\n");
  removeAccelerations(drive);
  EXPECT_EQ(warningsOf(drive, GravityUse::measure),
            "the map is not levelled: the recording has no accelerations of an IMU\n");
}

/** A second of scans, then ten seconds without any, again and again. */
TEST(Gravity, PiecesShorterThanTheWindowShowNoDirection)
{
  DriveWithImu drive(30, 0, Eigen::Vector3d::Zero());
  for (Frame& frame : drive.frames)
  {
    const std::size_t gaps = frame.index / 10;
    const double missing = 10 * static_cast<double>(gaps);
    frame.scan.stamp += missing;
    for (ImuSample& sample : frame.imu)
    {
      sample.stamp += missing;
    }
  }
  const GravityRun run(drive, GravityUse::measure, true);
  EXPECT_FALSE(run.backend.gravity());
  EXPECT_EQ(run.warnings(),
            "the map is not levelled: 0 of 3 directions of gravity that are needed; each takes "
            "gravity.window (4 s) without a gap, and 8 scans\n");
}

/** Of a live sensor; Frame::time() goes on. */
TEST(Gravity, AClockThatIsSetBackChangesNothing)
{
  DriveWithImu drive(40, 0, Eigen::Vector3d::Zero());
  const GravityRun before(drive, GravityUse::measure);
  constexpr double step = -20;  // [s]
  for (std::size_t i = 100; i < drive.frames.size(); ++i)
  {
    Frame& frame = drive.frames[i];
    frame.scan.stamp += step;
    frame.clock_offset = step;
    for (ImuSample& sample : frame.imu)
    {
      sample.stamp += step;
    }
  }
  const GravityRun after(drive, GravityUse::measure);
  ASSERT_TRUE(after.backend.gravity()) << after.warnings();
  EXPECT_EQ(after.backend.gravity()->directions, before.backend.gravity()->directions);
  EXPECT_TRUE(after.backend.gravity()->up_map.isApprox(before.backend.gravity()->up_map, 1e-6));
}

TEST(Gravity, WithoutAccelerationsNothingChanges)
{
  DriveWithImu drive(30, 1e-4, Eigen::Vector3d::Zero());
  removeAccelerations(drive);
  const GravityRun run(drive, GravityUse::fuse);
  EXPECT_FALSE(run.backend.gravity());
  EXPECT_EQ(run.warnings(), "");
  EXPECT_EQ(run.endError(drive), GravityRun(drive, GravityUse::off).endError(drive));
}
}  // namespace
}  // namespace dyslam
