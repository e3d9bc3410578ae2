// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/ScanPoses.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr double begin_of_drive = 1600000000.0;

/** A turn that gets faster. */
Pose driveAt(double time)
{
  return poseFromYpr(8 * time + time * time, 0.5 * time * time, 0, 0.3 * time, 0.01 * time, 0);
}

/** Poses of the first 3 s. */
Trajectory driveAtRate(double rate, double offset = 0)
{
  Trajectory trajectory;
  for (double i = 0; i <= 3 * rate; ++i)
  {
    const double time = offset + i / rate;
    trajectory.push_back(begin_of_drive + time, driveAt(time));
  }
  return trajectory;
}

void expectNear(const Pose& expected, const Pose& pose, double distance, double angle)
{
  const Pose error = expected.inverse() * pose;
  EXPECT_LT(error.translation().norm(), distance);
  EXPECT_LT(rotationAngle(error), angle);
}

TEST(ScanPoses, OfTheTimesOfTheTrajectoryAreUnchanged)
{
  const Trajectory drive = driveAtRate(10);
  const ScanPoses poses(drive, 0.01);
  for (const auto& [stamp, pose] : drive)
  {
    EXPECT_EQ(pose.matrix(), poses.at(stamp)->matrix());
    EXPECT_EQ(pose.matrix(), poses.at(stamp + 5e-7)->matrix()) << "rounded in a file";
  }
}

TEST(ScanPoses, BetweenThemAreInterpolated)
{
  const ScanPoses ins(driveAtRate(30, 0.0137), 0.01);
  const ScanPoses coarse(driveAtRate(4, 0.03), 0.01);
  for (double time = 0.1; time < 2.9; time += 0.1)
  {
    expectNear(driveAt(time), *ins.at(begin_of_drive + time), 1e-3, 1e-4);
    expectNear(driveAt(time), *coarse.at(begin_of_drive + time), 0.05, 1e-3);
  }
}

TEST(ScanPoses, AtTheEndsAndInGapsTheNearestWithinTheToleranceCounts)
{
  Trajectory drive;
  for (const double time : {0.0, 1.0, 1.5})
  {
    drive.push_back(begin_of_drive + time, driveAt(time));
  }
  const ScanPoses poses(drive, 0.02);
  const auto at = [&](double time) { return poses.at(begin_of_drive + time); };
  EXPECT_EQ(drive[0].pose.matrix(), at(-0.019)->matrix());
  EXPECT_FALSE(at(-0.021));
  EXPECT_EQ(drive[0].pose.matrix(), at(0.019)->matrix());
  EXPECT_FALSE(at(0.021)) << "1 s between the poses";
  EXPECT_TRUE(at(1.25)) << "0.5 s";
  EXPECT_EQ(drive[2].pose.matrix(), at(1.519)->matrix());
  EXPECT_FALSE(at(1.521));
  EXPECT_FALSE(ScanPoses(Trajectory(), 1).at(begin_of_drive));
}

TEST(ScanPoses, MotionIsTheStepOfATrajectoryOfTheScans)
{
  const Trajectory drive = driveAtRate(10);
  const ScanPoses poses(drive, 0.01);
  for (const std::size_t i : {0, 1, 2, 20, 30})
  {
    const TimedMotion motion = poses.motionDuring(drive[i].stamp, {-0.05, 0.05});
    const std::size_t current = i == 0 ? 1 : i;
    EXPECT_EQ(drive[current - 1].pose.matrix(), motion.from.matrix());
    EXPECT_EQ(drive[current].pose.matrix(), motion.to.matrix());
    EXPECT_EQ(drive[current].stamp - drive[current - 1].stamp, motion.dt);
  }
}

TEST(ScanPoses, MotionIsThatOfTheSweepOfAnyOther)
{
  for (const double rate : {10.0, 30.0, 100.0, 200.0})
  {
    for (const double offset : {0.0, 0.0037})
    {
      const ScanPoses poses(driveAtRate(rate, offset), 0.01);
      if (rate == 10 && offset == 0)
      {
        continue;  // of the scans
      }
      for (const double time : {0.1, 1.0, 2.8})
      {
        const TimedMotion motion = poses.motionDuring(begin_of_drive + time, {-0.02, 0.08});
        EXPECT_NEAR(0.1, motion.dt, 1e-6);
        expectNear(driveAt(time - 0.02).inverse() * driveAt(time + 0.08),
                   motion.from.inverse() * motion.to, 0.01, 1e-3);
      }
    }
  }
}

TEST(ScanPoses, AtTheEndsTheMotionIsThatOfTheNearestSweep)
{
  const ScanPoses poses(driveAtRate(100), 0.01);
  const TimedMotion first = poses.motionDuring(begin_of_drive, {-0.05, 0.05});
  expectNear(driveAt(0), first.from, 1e-3, 1e-4);
  expectNear(driveAt(0.1), first.to, 1e-3, 1e-4);
  const TimedMotion last = poses.motionDuring(begin_of_drive + 3, {-0.05, 0.05});
  expectNear(driveAt(2.9), last.from, 1e-3, 1e-4);
  expectNear(driveAt(3), last.to, 1e-3, 1e-4);
}

TEST(ScanPoses, WithoutASweepTheMotionIsTheNearestStep)
{
  Trajectory sparse;
  for (const double time : {0.0, 1.0, 2.0})
  {
    sparse.push_back(begin_of_drive + time, driveAt(time));
  }
  const ScanPoses poses(sparse, 0.01);
  for (const auto& span : {std::make_pair(-0.05, 0.05), std::make_pair(0.0, 0.0)})
  {
    const TimedMotion motion = poses.motionDuring(begin_of_drive + 1.003, span);
    EXPECT_EQ(1.0, motion.dt);
    EXPECT_EQ(sparse[0].pose.matrix(), motion.from.matrix());
    EXPECT_EQ(sparse[1].pose.matrix(), motion.to.matrix());
  }
  Trajectory one;
  one.push_back(begin_of_drive, driveAt(1));
  EXPECT_EQ(0, ScanPoses(one, 0.01).motionDuring(begin_of_drive, {-0.05, 0.05}).dt);
  EXPECT_EQ(0, ScanPoses(Trajectory(), 0.01).motionDuring(begin_of_drive, {-0.05, 0.05}).dt);
}

/** A scan is deskewed alike along the poses of the scans and along those of an INS. */
TEST(ScanPoses, OfAnInsDeskewAsThoseOfTheScans)
{
  Trajectory of_scans;
  Trajectory of_ins;
  const auto straight = [](double time) { return poseFromYpr(10 * time, 0, 0, 0, 0, 0); };
  for (int i = 0; i < 20; ++i)
  {
    of_scans.push_back(begin_of_drive + 0.1 * i, straight(0.1 * i));
  }
  for (int i = 0; i < 200; ++i)
  {
    of_ins.push_back(begin_of_drive + 0.0042 + 0.01 * i, straight(0.0042 + 0.01 * i));
  }
  Scan scan;
  scan.stamp = of_scans[7].stamp;
  for (float angle = 0; angle < 6; angle += 0.5F)
  {
    scan.points.emplace_back(20 * std::cos(angle), 20 * std::sin(angle), 1.0F);
    scan.time.push_back(0.016F * angle);
  }
  ThreadPool pool(1);
  for (const DeskewMode mode : {DeskewMode::time, DeskewMode::azimuth})
  {
    PreprocessOptions options;
    options.deskew = mode;
    const Preprocessor preprocessor(options, pool);
    const auto cloudAlong = [&](const Trajectory& trajectory)
    {
      const TimedMotion motion =
          ScanPoses(trajectory, 0.01).motionDuring(scan.stamp, preprocessor.sweepSpan(scan, 0.1));
      return preprocessor.prepare(scan, motion.from.inverse() * motion.to, motion.dt, 0.1);
    };
    const Cloud expected = cloudAlong(of_scans);
    const Cloud cloud = cloudAlong(of_ins);
    ASSERT_EQ(expected.size(), cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
    {
      EXPECT_LT((expected.points[i] - cloud.points[i]).norm(), 1e-4F);
    }
    EXPECT_GT((cloud.points.back() - scan.points.back()).norm(), 0.1F);
  }
}

TEST(Preprocessor, SweepsAreThoseOfTheirTimesOrOfTheReference)
{
  ThreadPool pool(1);
  PreprocessOptions options;
  options.sweep_reference = 0.25;
  Scan scan;
  scan.points.resize(3, {10, 0, 0});
  const auto untimed = Preprocessor(options, pool).sweepSpan(scan, 0.2);
  EXPECT_DOUBLE_EQ(-0.05, untimed.first);
  EXPECT_DOUBLE_EQ(0.15, untimed.second);
  scan.time = {0.01F, -0.03F, 0.06F};
  const auto timed = Preprocessor(options, pool).sweepSpan(scan, 0.2);
  EXPECT_FLOAT_EQ(-0.03F, static_cast<float>(timed.first));
  EXPECT_FLOAT_EQ(0.06F, static_cast<float>(timed.second));
  options.deskew = DeskewMode::azimuth;
  EXPECT_EQ(untimed, Preprocessor(options, pool).sweepSpan(scan, 0.2));
}
}  // namespace
}  // namespace dyslam
