// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/Axes.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
namespace
{
/** An S of 60 m, and the same with drift of a degree a metre, seen by a body turned by `turn`. */
PosePairs pathAndEstimate(const Eigen::Matrix3d& turn_reference,
                          const Eigen::Matrix3d& turn_estimate)
{
  PosePairs pairs;
  Pose truth = Pose::Identity();
  Pose drifted = Pose::Identity();
  for (int i = 0; i < 120; ++i)
  {
    const auto seen = [](const Pose& pose, const Eigen::Matrix3d& turn)
    {
      Pose turned = pose;
      turned.linear() = pose.rotation() * turn;
      return turned;
    };
    pairs.stamps.push_back(i);
    pairs.reference.push_back(seen(truth, turn_reference));
    pairs.estimate.push_back(seen(drifted, turn_estimate));
    const double yaw = 0.05 * std::sin(0.05 * i);
    truth = truth * poseFromYpr(0.5, 0, 0, yaw, 0, 0);
    drifted = drifted * poseFromYpr(0.48, 0.02, 0.01, yaw + 0.009, 0, 0);
  }
  return pairs;
}
}  // namespace

TEST(BodyAxes, CamerasAreFoundOnEitherSide)
{
  const Eigen::Matrix3d lidar = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d camera;  // a lidar's coordinates of a camera's axes
  camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  EXPECT_EQ(BodyAxes::same, compareBodyAxes(pathAndEstimate(lidar, lidar)));
  EXPECT_EQ(BodyAxes::same, compareBodyAxes(pathAndEstimate(camera, camera)));
  EXPECT_EQ(BodyAxes::estimate_camera, compareBodyAxes(pathAndEstimate(lidar, camera)));
  EXPECT_EQ(BodyAxes::reference_camera, compareBodyAxes(pathAndEstimate(camera, lidar)));
  const Eigen::Matrix3d backwards = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  EXPECT_EQ(BodyAxes::differ, compareBodyAxes(pathAndEstimate(lidar, backwards)));
  Eigen::Matrix3d
      left;  // x to the left: its motion, along -y, is that of a lidar turned as a camera
  left << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_EQ(BodyAxes::differ, compareBodyAxes(pathAndEstimate(left, lidar)));
  EXPECT_EQ(BodyAxes::differ, compareBodyAxes(pathAndEstimate(lidar, left)));
}

TEST(BodyAxes, CamerasAreFoundIfAnEstimateIsTooShort)
{
  const Eigen::Matrix3d lidar = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d camera;
  camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const auto ofHalf = [](PosePairs pairs)
  {
    for (Pose& pose : pairs.estimate)
    {
      pose.translation() *= 0.5;
    }
    return compareBodyAxes(pairs);
  };
  EXPECT_EQ(BodyAxes::same, ofHalf(pathAndEstimate(lidar, lidar)));
  EXPECT_EQ(BodyAxes::estimate_camera, ofHalf(pathAndEstimate(lidar, camera)));
  EXPECT_EQ(BodyAxes::reference_camera, ofHalf(pathAndEstimate(camera, lidar)));
  const Eigen::Matrix3d backwards = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  EXPECT_EQ(BodyAxes::same, ofHalf(pathAndEstimate(lidar, backwards))) << "of a failed estimate";
}

TEST(BodyAxes, NothingIsSaidWithoutMotionOrOfAFailedEstimate)
{
  EXPECT_EQ(BodyAxes::same, compareBodyAxes(PosePairs()));
  PosePairs pairs = pathAndEstimate(Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity());
  for (Pose& pose : pairs.estimate)
  {
    pose = Pose::Identity();
  }
  EXPECT_EQ(BodyAxes::same, compareBodyAxes(pairs));
}
}  // namespace dyslam
