// SPDX-License-Identifier: BSD-3-Clause
#include "../src/results/RunStatistics.h"

#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/MotionSensors.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace dyslam
{
namespace
{
Frame failed(bool map_restarted,
             const std::string& reason,
             FailureCause cause = FailureCause::estimation)
{
  Frame frame;
  frame.motion.map_restarted = map_restarted;
  frame.motion.reason = reason;
  frame.motion.cause = cause;
  return frame;
}

bool hasWarning(const RunStatistics& statistics, const std::string& part)
{
  const auto warnings = statistics.warnings(false);
  return std::any_of(warnings.begin(), warnings.end(),
                     [&part](const std::string& warning)
                     { return warning.find(part) != std::string::npos; });
}

TEST(RunStatistics, CountsMapRestartsWhateverTheReasonsSay)
{
  RunStatistics statistics;
  statistics.add(failed(false, "no overlap; the map is restarted"));
  EXPECT_FALSE(hasWarning(statistics, "restarted"));
  statistics.add(failed(true, "no overlap"));
  EXPECT_TRUE(hasWarning(statistics, "the local map was restarted once"));
  statistics.add(failed(true, ""));
  EXPECT_TRUE(hasWarning(statistics, "the local map was restarted 2 times"));
}

TEST(RunStatistics, AdvisesByTheCauseOfTheMostFrequentReason)
{
  const auto failureOf = [](const std::string& reason, FailureCause cause)
  {
    RunStatistics statistics;
    statistics.add(failed(false, "another reason"));
    statistics.add(failed(false, reason + " 1", cause));
    statistics.add(failed(false, reason + " 2", cause));
    return statistics.failure("my.ini", {});
  };
  const auto has = [](const std::string& text, const std::string& part)
  { return text.find(part) != std::string::npos; };
  const std::string motion = failureOf("the scan has ...", FailureCause::estimation);
  EXPECT_TRUE(has(motion, "; try the settings that fit the sensor (no -c), -c handheld.ini"));
  EXPECT_TRUE(has(motion, "odometry.start_speed")) << motion;
  const std::string few = failureOf("few returns", FailureCause::recording);
  EXPECT_TRUE(has(few,
                  "; most often because: few returns 2; check the recording, and how it was "
                  "converted"))
      << few;
  EXPECT_FALSE(has(few, "start_speed") || has(few, "handheld")) << few;
  const std::string range = failureOf("few points left", FailureCause::preprocessing);
  EXPECT_TRUE(has(range,
                  "; change these settings, or check that the points are in metres, in the frame "
                  "of the lidar"));
  EXPECT_FALSE(has(range, "start_speed")) << range;
}

/** As in clouds of Ouster's os_lidar, and of lidars whose azimuth 0 is y. */
TEST(RunStatistics, AVehicleThatDoesNotMoveForwardIsAWarning)
{
  const auto statisticsOf = [](double x, double y, int steps)
  {
    RunStatistics statistics;
    for (int i = 0; i < steps; ++i)
    {
      Frame frame;
      frame.odometry.status = MotionStatus::converged;
      frame.motion.status = MotionStatus::converged;
      frame.motion.T_previous_current.translation() = Eigen::Vector3d(x, y, 0);
      statistics.add(frame);
    }
    return statistics;
  };
  EXPECT_EQ(statisticsOf(1, 0.2, 20).directionWarning(), "");
  EXPECT_EQ(statisticsOf(-1, 0, 5).directionWarning(), "") << "a manoeuvre";
  EXPECT_TRUE(hasWarning(statisticsOf(-1, 0, 20), "the vehicle moved 180 deg to the left"));
  EXPECT_TRUE(hasWarning(statisticsOf(0, -1, 20), "the vehicle moved 90 deg to the right"));
  EXPECT_TRUE(hasWarning(statisticsOf(0, -1, 20),
                         "(--sensor-pose) that is 90 deg more: '0 0 0 90 0 0' if it had none"));
  EXPECT_TRUE(hasWarning(statisticsOf(0, 1, 20), "90 deg less: '0 0 0 -90 0 0' if it had none"));
}

TEST(RunStatistics, PointsInTheFrameOfAMapAreAWarning)
{
  // Points around the lidar, which has driven by `lidar_step` when the cloud is written, and by
  // `odometry_step` in the estimate.
  const auto statisticsOf = [](float lidar_step, double odometry_step)
  {
    RunStatistics statistics;
    for (int i = 0; i < 30; ++i)
    {
      Frame frame;
      frame.odometry.status = MotionStatus::converged;
      frame.motion.status = MotionStatus::converged;
      frame.T_odom_vehicle.translation().x() = odometry_step * i;
      for (int k = 0; k < 640; ++k)
      {
        const float azimuth = 0.0098F * static_cast<float>(k);
        const float range = k < 300 ? 5.0F : 20.0F;  // a truck on one side
        frame.cloud.points.emplace_back(
            range * std::cos(azimuth) + lidar_step * static_cast<float>(i),
            range * std::sin(azimuth), 0);
      }
      statistics.add(frame);
    }
    return statistics;
  };
  const RunStatistics map_frame = statisticsOf(1, 0);
  EXPECT_TRUE(hasWarning(map_frame, "in the frame of a map"));
  EXPECT_EQ(map_frame.verdict(), "doubtful");
  EXPECT_EQ(statisticsOf(0, 0).verdict(), "usable") << "at rest";
  EXPECT_EQ(statisticsOf(0, 1).verdict(), "usable");
  EXPECT_EQ(statisticsOf(1, 1).frameWarning(), "") << "an odd sensor, but it drives";
}

/** Points around (x, -30) m, as of a spinning lidar. */
Frame around(float x)
{
  Frame frame;
  frame.odometry.status = MotionStatus::converged;
  frame.motion.status = MotionStatus::converged;
  for (int k = 0; k < 640; ++k)
  {
    const float azimuth = 0.0098F * static_cast<float>(k);
    const float range = k % 100 < 50 ? 5.0F : 25.0F;
    frame.cloud.points.emplace_back(x + range * std::cos(azimuth), range * std::sin(azimuth) - 30,
                                    0);
  }
  return frame;
}

TEST(RunStatistics, PointsInTheFrameOfAMapWithAFarOriginAreAWarning)
{
  for (const float step : {-1.0F, 1.0F})  // towards the origin and away from it
  {
    RunStatistics statistics;
    RunStatistics at_rest;  // a lidar on a mast
    for (int i = 0; i < 25; ++i)
    {
      statistics.add(around(60 + step * static_cast<float>(i)));
      at_rest.add(around(60 + (i % 2 == 0 ? step : 0)));
    }
    EXPECT_TRUE(hasWarning(statistics, "in the frame of a map")) << step;
    EXPECT_EQ(statistics.verdict(), "doubtful") << step;
    EXPECT_EQ(at_rest.frameWarning(), "") << step;
  }
}

/** A cloud of points in one direction. */
Frame looking(double x, const Eigen::Vector2f& direction, std::size_t points)
{
  Frame frame;
  frame.odometry.status = MotionStatus::converged;
  frame.motion.status = MotionStatus::converged;
  frame.T_odom_vehicle.translation().x() = x;
  frame.cloud.points.assign(points, Eigen::Vector3f(10 * direction.x(), 10 * direction.y(), 0));
  return frame;
}

TEST(RunStatistics, AWayThereAndBackIsNoMapFrame)
{
  RunStatistics statistics;
  for (int i = 0; i <= 40; ++i)  // along a wall, which is on the other side on the way back
  {
    const bool is_back = i > 20;
    statistics.add(looking(is_back ? 40 - i : i, {0, is_back ? -1.0F : 1.0F}, 500));
  }
  EXPECT_EQ(statistics.frameWarning(), "");
  EXPECT_EQ(statistics.verdict(), "usable");
}

TEST(RunStatistics, ATurnOnTheSpotIsNoMapFrame)
{
  RunStatistics statistics;
  for (int i = 0; i < 40; ++i)  // beside a wall, which all of the points are on
  {
    const float turned = 0.08F * static_cast<float>(i);
    Frame frame = looking(0, {std::cos(turned), -std::sin(turned)}, 500);
    frame.T_odom_vehicle.rotate(
        Eigen::AngleAxisd(static_cast<double>(turned), Eigen::Vector3d::UnitZ()));
    statistics.add(frame);
  }
  EXPECT_EQ(statistics.frameWarning(), "");
}

TEST(RunStatistics, ATruckThatDrivesAwayIsNoMapFrame)
{
  RunStatistics statistics;
  for (int i = 0; i < 30; ++i)  // it hides all that a lidar with a narrow view sees
  {
    statistics.add(looking(0, {i < 10 ? 0.5F : 4.0F, 0}, 500));
  }
  EXPECT_EQ(statistics.frameWarning(), "");
}

TEST(RunStatistics, ScansWithFewOrNoPointsAreNoMapFrame)
{
  for (const std::size_t of_first : {0U, 100U})
  {
    RunStatistics statistics;
    statistics.add(looking(0, {-1, 0}, of_first));  // the sensor starts
    for (int i = 0; i < 30; ++i)
    {
      statistics.add(looking(0, {1, 0}, i % 3 == 0 ? 0 : 500));
    }
    EXPECT_EQ(statistics.frameWarning(), "") << of_first;
  }
}

/** A gyroscope in degrees makes all registrations fail. */
TEST(RunStatistics, AdvisesToDoWithoutTheMotionSensorsInUse)
{
  RunStatistics statistics;
  MotionSensorOptions sensors;
  const auto advises = [&](const std::string& part)
  { return statistics.failure("", sensors).find(part) != std::string::npos; };
  statistics.add(failed(false, "no overlap"));
  EXPECT_FALSE(advises("motion_sensors")) << "there are none";
  Frame frame = failed(false, "no overlap");
  frame.imu.emplace_back();
  statistics.add(frame);
  EXPECT_TRUE(advises("motion_sensors.gyroscope=false"));
  EXPECT_FALSE(advises("wheel_odometry=false")) << "there is none";
  sensors.gyroscope = false;
  EXPECT_FALSE(advises("motion_sensors")) << "it was not used";
  frame.wheels.emplace_back();
  statistics.add(frame);
  EXPECT_TRUE(advises("be wrong: motion_sensors.wheel_odometry=false"));
  sensors.wheel_odometry = false;
  EXPECT_FALSE(advises("motion_sensors"));
}

TEST(RunStatistics, DoesNotAdviseTheIniThatWasGiven)
{
  RunStatistics statistics;
  statistics.add(failed(false, "no overlap"));
  const std::string failure = statistics.failure("/share/handheld.ini", {});
  EXPECT_EQ(failure.find("-c handheld.ini"), std::string::npos) << failure;
  EXPECT_NE(failure.find("try the settings that fit the sensor (no -c), or odometry.start_speed"),
            std::string::npos)
      << failure;
}

/** One threshold and one wording for console, report.json and report.html. */
TEST(RunStatistics, TheVerdictFitsWarningsAndFailure)
{
  const auto statisticsOf = [](int failures, int restarts)
  {
    RunStatistics statistics;
    for (int i = 0; i < 30; ++i)
    {
      Frame frame = failed(i < restarts, "no overlap");
      frame.motion.status = i >= failures ? MotionStatus::converged : MotionStatus::not_found;
      statistics.add(frame);
    }
    return statistics;
  };
  const RunStatistics few = statisticsOf(6, 0);
  EXPECT_EQ(few.verdict(), "usable");
  EXPECT_FALSE(hasWarning(few, "check trajectory and map"));
  const RunStatistics many = statisticsOf(10, 2);
  EXPECT_EQ(many.verdict(), "doubtful");
  EXPECT_EQ(many.failure("", {}), "");
  EXPECT_TRUE(hasWarning(many,
                         "10 of 30 scans could not be registered: check trajectory and map; most "
                         "often because: no overlap"));
  EXPECT_EQ(statisticsOf(15, 0).verdict(), "doubtful");
  const RunStatistics restarted = statisticsOf(5, 1);
  EXPECT_EQ(restarted.verdict(), "doubtful");
  EXPECT_TRUE(hasWarning(restarted, "check trajectory and map"));
  const RunStatistics most = statisticsOf(16, 0);
  EXPECT_EQ(most.verdict(), "unusable");
  EXPECT_EQ(most.failure("", {}).find(
                "16 of 30 scans could not be registered: do not trust trajectory and map"),
            0U);
  EXPECT_FALSE(hasWarning(most, "check trajectory and map"));
}

TEST(RunStatistics, NamesMissingDeskewingAsAReasonOfFailures)
{
  const auto statisticsOf = [](int failures, const std::vector<float>& phase)
  {
    RunStatistics statistics;
    for (int i = 0; i < 30; ++i)
    {
      Frame frame = failed(false, "no overlap");
      frame.motion.status = i >= failures ? MotionStatus::converged : MotionStatus::not_found;
      frame.cloud.points.assign(3, Eigen::Vector3f::Ones());
      frame.cloud.phase = phase;
      statistics.add(frame);
    }
    return statistics;
  };
  const std::vector<float> none;
  const std::vector<float> equal(3, 0.F);
  const std::vector<float> differing{0, 0.1F, 0.2F};
  EXPECT_TRUE(statisticsOf(3, none).deskewingAdvice().empty()) << "nothing is wrong";
  EXPECT_TRUE(statisticsOf(10, differing).deskewingAdvice().empty());
  EXPECT_TRUE(hasWarning(statisticsOf(10, none), "the scans were not deskewed"));
  EXPECT_TRUE(hasWarning(statisticsOf(10, none), "preprocess.deskew=azimuth"));
  EXPECT_TRUE(hasWarning(statisticsOf(10, equal), "all points of a scan have the same time"));
  EXPECT_FALSE(hasWarning(statisticsOf(20, none), "deskewed")) << "it is in the failure";
  EXPECT_NE(statisticsOf(20, none).failure("", {}).find("the scans were not deskewed"),
            std::string::npos);
  EXPECT_EQ(statisticsOf(20, differing).failure("", {}).find("deskewed"), std::string::npos);

  RunStatistics restarted = statisticsOf(0, none);
  restarted.add(failed(true, "no overlap"));
  EXPECT_TRUE(hasWarning(restarted, "the scans were not deskewed"));
}

/** Their motions are measured, and their points are in the map. */
TEST(RunStatistics, ScansThatDidNotSettleAreRegistered)
{
  const auto statisticsOf = [](int not_settled)
  {
    RunStatistics statistics;
    for (int i = 0; i < 30; ++i)
    {
      Frame frame;
      frame.is_keyframe = true;
      frame.odometry.status = MotionStatus::converged;
      frame.motion.status = i < not_settled ? MotionStatus::not_settled : MotionStatus::converged;
      statistics.add(frame);
    }
    return statistics;
  };
  const RunStatistics all = statisticsOf(30);
  EXPECT_EQ(all.registration_failures.total(), 0U);
  EXPECT_EQ(all.unregistered_keyframes, 0U);
  EXPECT_EQ(all.failure("", {}), "");
  EXPECT_EQ(all.verdict(), "usable");
  EXPECT_EQ(
      all.warnings(false),
      std::vector<std::string>{"the registration of 30 of 30 scans ended before it converged: "
                               "their motions are less accurate; raise "
                               "refine.max_iterations"});
  EXPECT_TRUE(statisticsOf(6).warnings(false).empty());
}

TEST(RunStatistics, KeepsMapRestartsWhenARunIsResumed)
{
  RunStatistics statistics;
  statistics.add(failed(true, "no overlap", FailureCause::preprocessing));
  StateArchive saved;
  saved(statistics);
  RunStatistics resumed;
  StateArchive archive(saved.bytes());
  archive(resumed);
  archive.requireEnd();
  resumed.add(failed(true, "no overlap"));
  EXPECT_TRUE(hasWarning(resumed, "the local map was restarted 2 times"));
  EXPECT_EQ(resumed.registration_failures.total(), 2U);
  EXPECT_EQ(resumed.registration_failures.mostFrequent().count, 2U);
}

TEST(RunStatistics, TheAdviceOfASecondPassIsOneOfTheWarnings)
{
  const auto statisticsOf = [](int moving)
  {
    Frame frame;
    frame.motion.status = MotionStatus::converged;
    frame.odometry.status = MotionStatus::converged;
    frame.cloud.points.resize(100);
    frame.moving.resize(100);
    std::fill_n(frame.moving.begin(), moving, true);
    RunStatistics statistics;
    statistics.add(frame);
    return statistics;
  };
  const RunStatistics dense = statisticsOf(16);
  const std::string advice = dense.secondPassAdvice(false);
  EXPECT_EQ(advice.find("16 % of the points move"), 0U) << advice;
  EXPECT_EQ(dense.warnings(false), std::vector<std::string>{advice});
  EXPECT_EQ(dense.secondPassAdvice(true), "") << "this is the second one";
  EXPECT_TRUE(dense.warnings(true).empty());
  EXPECT_EQ(statisticsOf(15).secondPassAdvice(false), "");
}
}  // namespace
}  // namespace dyslam
