// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/eval/TrajectoryMetrics.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "RealData.h"

namespace dyslam
{
namespace
{
constexpr double kDegrees = 180.0 / M_PI;

PosePairs pairsOf(const std::vector<Pose>& reference, const std::vector<Pose>& estimate)
{
  Trajectory r;
  Trajectory e;
  for (std::size_t i = 0; i < reference.size(); ++i)
  {
    r.push_back(static_cast<double>(i), reference[i]);
  }
  for (std::size_t i = 0; i < estimate.size(); ++i)
  {
    e.push_back(static_cast<double>(i), estimate[i]);
  }
  return associateByIndex(r, e);
}

/** A curved path with changing pitch, in steps of 1 m. */
std::vector<Pose> winding(std::size_t count)
{
  std::vector<Pose> poses{Pose::Identity()};
  for (std::size_t i = 1; i < count; ++i)
  {
    const double phase = 0.02 * static_cast<double>(i);
    poses.push_back(poses.back() *
                    poseFromYpr(1, 0, 0, 0.03 * std::sin(phase), 0.01 * std::cos(phase), 0));
  }
  return poses;
}

std::vector<Pose> straight(std::size_t count, double step)
{
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i)
  {
    poses.push_back(poseFromYpr(step * static_cast<double>(i), 0, 0, 0, 0, 0));
  }
  return poses;
}

TEST(Association, ByTimeIsOneToOneAndNearest)
{
  Trajectory reference;
  Trajectory estimate;
  for (const double t : {0.0, 1.0, 2.0, 3.0})
  {
    reference.push_back(t, poseFromYpr(t, 0, 0, 0, 0, 0));
  }
  for (const double t : {0.004, 0.001, 1.5, 2.0, 9.0})
  {
    estimate.push_back(t, poseFromYpr(10 + t, 0, 0, 0, 0, 0));
  }
  const auto pairs = associateByTime(reference, estimate, 0.01);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_DOUBLE_EQ(pairs.stamps[0], 0);
  EXPECT_DOUBLE_EQ(pairs.estimate[0].translation().x(), 10.001);
  EXPECT_DOUBLE_EQ(pairs.stamps[1], 2);
  EXPECT_EQ(pairs.reference_size, 4U);
  EXPECT_EQ(pairs.estimate_size, 5U);
}

TEST(Association, TheReferenceIsInterpolatedInSmallGaps)
{
  Trajectory reference;
  for (const double t : {0.0, 0.2, 0.4, 2.0, 2.2})
  {
    reference.push_back(t, poseFromYpr(10 * t, 0, 0, 0.1 * t, 0, 0));
  }
  Trajectory estimate;
  for (const double t : {-0.1, 0.0, 0.05, 0.35, 1.0, 2.1, 2.3})
  {
    estimate.push_back(t, poseFromYpr(t, 0, 0, 0, 0, 0));
  }
  const PosePairs pairs = associateInterpolated(reference, estimate, 0.3);
  ASSERT_EQ(pairs.size(), 4U) << "those before, in the gap and after have none";
  EXPECT_DOUBLE_EQ(pairs.stamps[1], 0.05);
  EXPECT_NEAR(pairs.reference[1].translation().x(), 0.5, 1e-3);
  EXPECT_NEAR(pairs.reference[2].translation().x(), 3.5, 1e-3);
  EXPECT_DOUBLE_EQ(pairs.estimate[3].translation().x(), 2.1);
  EXPECT_EQ(pairs.reference_size, 5U);
  EXPECT_EQ(pairs.estimate_size, 7U);
  EXPECT_EQ(associateInterpolated({}, estimate, 1).size(), 0U);
}

TEST(Association, CountsAndSkipsNonFinitePoses)
{
  auto estimate = straight(5, 1);
  estimate[2].translation().x() = std::numeric_limits<double>::quiet_NaN();
  const auto pairs = pairsOf(straight(5, 1), estimate);
  EXPECT_EQ(pairs.size(), 4U);
  EXPECT_EQ(pairs.not_finite, 1U);
  const auto report = evaluateTrajectory("x", pairs);
  EXPECT_EQ(report.not_finite, 1U);
  EXPECT_NEAR(report.absolute.translation.max, 0, 1e-9);
}

TEST(Association, EmptyInputs)
{
  EXPECT_EQ(associateByTime({}, {}, 1).size(), 0U);
  EXPECT_EQ(associateByIndex({}, {}).size(), 0U);
  EXPECT_THROW((void)evaluateTrajectory("x", PosePairs()), UserError);
  EXPECT_THROW((void)evaluateTrajectory("x", pairsOf(straight(1, 1), straight(1, 1))), UserError);
}

TEST(KittiDrift, ScaleErrorGivesItsPercentage)
{
  const auto drift = kittiDrift(pairsOf(straight(400, 1), straight(400, 1.02)), {100, 200}, 10);
  // The segment ends at the first frame beyond its length: 101 steps of 2 cm over 100 m.
  EXPECT_NEAR(drift.per_length[0].translation_percent, 2.02, 1e-9);
  EXPECT_NEAR(drift.per_length[1].translation_percent, 100 * 201 * 0.02 / 200, 1e-9);
  EXPECT_EQ(drift.per_length[0].segments, 30U);
  EXPECT_EQ(drift.per_length[1].segments, 20U);
  EXPECT_EQ(drift.overall.segments, 50U);
  EXPECT_NEAR(drift.overall.translation_percent, (30 * 2.02 + 20 * 2.01) / 50, 1e-9);
  EXPECT_NEAR(drift.overall.rotation_deg_per_100m, 0, 1e-9);
}

TEST(KittiDrift, YawErrorGivesDegreesPer100Metres)
{
  const double yaw_per_step = 1e-4;
  std::vector<Pose> estimate{Pose::Identity()};
  for (int i = 1; i < 300; ++i)
  {
    estimate.push_back(estimate.back() * poseFromYpr(1, 0, 0, yaw_per_step, 0, 0));
  }
  const auto drift = kittiDrift(pairsOf(straight(300, 1), estimate), {100}, 10);
  EXPECT_NEAR(drift.overall.rotation_deg_per_100m, 101 * yaw_per_step * kDegrees, 1e-9);
}

TEST(KittiDrift, ShortRunsHaveNoSegments)
{
  const auto drift = kittiDrift(pairsOf(straight(50, 1), straight(50, 1)), {100}, 10);
  EXPECT_EQ(drift.overall.segments, 0U);
  EXPECT_THROW((void)kittiDrift({}, {0}, 10), std::invalid_argument);
  EXPECT_THROW((void)kittiDrift({}, {100}, 0), std::invalid_argument);
}

TEST(RelativePoseError, IsInvariantToTheEstimatesFrame)
{
  const auto reference = winding(200);
  const Pose other_frame = poseFromYpr(7, -3, 2, 1, 0.2, -0.3);
  std::vector<Pose> estimate;
  for (std::size_t i = 0; i < reference.size(); ++i)
  {
    estimate.push_back(other_frame * reference[i]);
  }
  estimate[100].translation() += Eigen::Vector3d(0, 0, 0.5);
  const auto error = relativePoseError(pairsOf(reference, estimate));
  EXPECT_EQ(error.translation.count, 199U);
  EXPECT_NEAR(error.translation.max, 0.5, 1e-9);
  EXPECT_NEAR(error.translation.rmse, std::sqrt(2 * 0.25 / 199), 1e-9);
  EXPECT_NEAR(error.translation.median, 0, 1e-9);
  EXPECT_NEAR(error.rotation_deg.max, 0, 1e-5);
}

TEST(Alignment, Se3RecoversAKnownMotionAndMinimisesTheSquaredError)
{
  const auto reference = winding(150);
  const Pose T = poseFromYpr(30, -20, 4, 2.5, 0.3, -0.8);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<Pose> exact;
  std::vector<Pose> noisy;
  for (const auto& pose : reference)
  {
    exact.push_back(T.inverse() * pose);
    noisy.push_back(exact.back());
    noisy.back().translation() += Eigen::Vector3d(noise(random), noise(random), noise(random));
  }
  EXPECT_TRUE(alignEstimate(pairsOf(reference, exact), Alignment::se3).isApprox(T, 1e-9));

  const auto pairs = pairsOf(reference, noisy);
  const Pose best = alignEstimate(pairs, Alignment::se3);
  const auto cost = [&](const Pose& candidate)
  {
    double sum = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
    {
      sum += (candidate * pairs.estimate[i].translation() - pairs.reference[i].translation())
                 .squaredNorm();
    }
    return sum;
  };
  for (int axis = 0; axis < 6; ++axis)
  {
    for (const double sign : {-1.0, 1.0})
    {
      Vector6 step = Vector6::Zero();
      step[axis] = sign * 1e-4;
      EXPECT_LT(cost(best), cost(best * expSE3(step))) << axis;
    }
  }
}

TEST(Alignment, OrientationsDetermineTheRollOfAStraightPath)
{
  const Pose T = poseFromYpr(5, 6, 7, 0.4, 0.1, 0.9);
  std::vector<Pose> estimate;
  for (const auto& pose : straight(50, 1))
  {
    estimate.push_back(T.inverse() * pose);
  }
  const auto error = absoluteTrajectoryError(pairsOf(straight(50, 1), estimate), Alignment::se3);
  EXPECT_NEAR(error.translation.max, 0, 1e-6);
  EXPECT_NEAR(error.rotation_deg.max, 0, 1e-3);
  EXPECT_TRUE(error.turned_by_orientations);
  EXPECT_FALSE(absoluteTrajectoryError(pairsOf(straight(50, 1), estimate), Alignment::first)
                   .turned_by_orientations);
}

/** Errors after SE(3) alignment of a 100 m path with lateral amplitude `bow` [m] to a transformed
 * copy with lateral noise [m]. */
AbsoluteTrajectoryError noisyLineError(double bow, double sigma = 0.01)
{
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, sigma);
  const Pose T = poseFromYpr(5, 6, 7, 0.4, 0.1, 0.9);
  std::vector<Pose> reference = straight(100, 1);
  std::vector<Pose> estimate;
  for (auto& pose : reference)
  {
    pose.translation().y() = bow * std::sin(0.1 * pose.translation().x());
    Pose noisy = pose;
    noisy.translation().y() += noise(random);
    noisy.translation().z() += noise(random);
    estimate.push_back(T.inverse() * noisy);
  }
  return absoluteTrajectoryError(pairsOf(reference, estimate), Alignment::se3);
}

TEST(Alignment, LateralNoiseDoesNotRollAStraightPath)
{
  for (const double bow : {0.0, 0.001, 0.02})
  {
    const auto error = noisyLineError(bow);
    EXPECT_LT(error.rotation_deg.max, 0.1) << bow;
    EXPECT_LT(error.translation.max, 0.06) << bow;
  }
  // With 10 m across, the positions alone determine the rotation.
  EXPECT_LT(noisyLineError(10).rotation_deg.max, 0.1);
  EXPECT_FALSE(noisyLineError(10).turned_by_orientations);
  // A slight bow is less informative than the orientations, since the positions are noisy.
  EXPECT_LT(noisyLineError(3, 0.4).rotation_deg.max, 0.3);
}

TEST(Alignment, PositionsAloneAreAlignedWithoutOrientations)
{
  const Pose T = poseFromYpr(10, -3, 2, 1.2, 0.1, -0.2);
  std::vector<Pose> reference = winding(200);
  std::vector<Pose> estimate;
  for (Pose& pose : reference)
  {
    estimate.push_back(T.inverse() * pose);
    pose.linear().setIdentity();
  }
  PosePairs pairs = pairsOf(reference, estimate);
  pairs.positions_only = true;
  EXPECT_TRUE(alignEstimate(pairs, Alignment::se3).isApprox(T, 1e-9));
  const AbsoluteTrajectoryError error = absoluteTrajectoryError(pairs, Alignment::se3);
  EXPECT_LT(error.translation.max, 1e-9);
  EXPECT_EQ(error.rotation_deg.count, 0u);

  PosePairs line = pairsOf(straight(50, 1), straight(50, 1));  // its roll is any
  line.positions_only = true;
  for (Pose& pose : line.estimate)
  {
    pose = T * pose;
  }
  EXPECT_LT(absoluteTrajectoryError(line, Alignment::se3).translation.max, 1e-9);
}

TEST(Alignment, NoneAndFirst)
{
  std::vector<Pose> shifted;
  for (const auto& pose : straight(10, 1))
  {
    shifted.push_back(poseFromYpr(0, 3, 0, 0.5, 0, 0) * pose);
  }
  const auto pairs = pairsOf(straight(10, 1), shifted);
  EXPECT_NEAR(absoluteTrajectoryError(pairs, Alignment::none).rotation_deg.mean, 0.5 * kDegrees,
              1e-6);
  EXPECT_NEAR(absoluteTrajectoryError(pairs, Alignment::none).translation.min, 3, 1.5);
  EXPECT_NEAR(absoluteTrajectoryError(pairs, Alignment::first).translation.max, 0, 1e-9);
  EXPECT_EQ(alignmentFromString("first"), Alignment::first);
  EXPECT_THROW((void)alignmentFromString("sim3"), UserError);
}

TEST(ForwardRatio, MeasuresUnderestimationInAnyFrame)
{
  EXPECT_NEAR(*forwardRatio(pairsOf(straight(20, 1), straight(20, 0.8))), 0.8, 1e-9);
  const Pose T_camera = poseFromYpr(0, 0, 0, 1.2, -0.7, 0.4);
  std::vector<Pose> reference;
  std::vector<Pose> estimate;
  for (int i = 0; i < 20; ++i)
  {
    reference.push_back(T_camera * poseFromYpr(0, 0, i, 0, 0, 0) * T_camera.inverse());
    estimate.push_back(T_camera * poseFromYpr(0, 0, 0.5 * i, 0, 0, 0) * T_camera.inverse());
  }
  EXPECT_NEAR(*forwardRatio(pairsOf(reference, estimate)), 0.5, 1e-9);
  EXPECT_FALSE(forwardRatio(pairsOf(straight(5, 0), straight(5, 1))));
}

TEST(EndError, IsTheDriftOfTheLastPose)
{
  const auto error = endError(pairsOf(straight(101, 1), straight(101, 1.03)));
  EXPECT_NEAR(error.translation, 3, 1e-9);
  EXPECT_NEAR(error.percent, 3, 1e-9);
  EXPECT_NEAR(error.rotation_deg, 0, 1e-9);
}

std::vector<Pose> readKitti(const std::string& path)
{
  std::ifstream file(path);
  std::vector<Pose> poses;
  for (std::string line; std::getline(file, line);)
  {
    std::istringstream numbers(line);
    Pose pose = Pose::Identity();
    for (int i = 0; i < 12; ++i)
    {
      numbers >> pose.matrix()(i / 4, i % 4);
    }
    poses.push_back(orthonormalised(pose));
  }
  return poses;
}

TEST(KittiDrift, ReproducesPublishedFigures)
{
  DYSLAM_REQUIRE_DATA("kitti_odometry_text");
  const std::string folder = *realDataFolder("kitti_odometry_text") + "/";
  struct Expected
  {
    double t_rel;  // as published with the SiMpLE estimates
    double r_rel;  // of an independent evaluator
  };
  const Expected expected[] = {{0.6667, 0.3447}, {0.7749, 0.1128}, {0.6263, 0.2053},
                               {0.7369, 0.1399}, {0.4067, 0.1635}, {0.3372, 0.2803},
                               {0.2613, 0.0987}, {0.4706, 0.4444}, {0.8236, 0.2210},
                               {0.5684, 0.1783}, {0.6454, 0.3556}};
  const TrajectoryMetricsOptions options;
  double sum = 0;
  for (int sequence = 0; sequence < 11; ++sequence)
  {
    const std::string name = (sequence < 10 ? "/0" : "/") + std::to_string(sequence) + ".txt";
    const auto reference = readKitti(folder + "poses_gt_cam0" + name);
    const auto estimate = readKitti(folder + "est_simple_online_cam0" + name);
    ASSERT_GT(reference.size(), 100U) << folder << name;
    const auto drift = kittiDrift(pairsOf(reference, estimate), options.lengths, 10);
    EXPECT_NEAR(drift.overall.translation_percent, expected[sequence].t_rel, 0.5e-3) << name;
    EXPECT_NEAR(drift.overall.rotation_deg_per_100m, expected[sequence].r_rel, 0.5e-3) << name;
    sum += drift.overall.translation_percent;
  }
  EXPECT_NEAR(sum / 11, 0.5744, 0.5e-4);

  // Lidar poses against camera poses: a wrong frame must give a large error.
  const auto camera = readKitti(folder + "poses_gt_cam0/04.txt");
  const auto lidar = readKitti(folder + "est_aloam_lidar/04_pred.txt");
  const auto wrong = kittiDrift(pairsOf(camera, lidar), options.lengths, 10);
  EXPECT_NEAR(wrong.overall.translation_percent, 141.405, 1e-2);
  const auto right =
      kittiDrift(pairsOf(readKitti(folder + "poses_gt_lidar/04.txt"), lidar), options.lengths, 10);
  EXPECT_NEAR(right.overall.translation_percent, 0.782, 0.5e-3);
}
}  // namespace
}  // namespace dyslam
