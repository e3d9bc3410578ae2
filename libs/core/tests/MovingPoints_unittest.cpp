// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/MovingPoints.h>
#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
Frame frameOf(std::size_t points)
{
  Frame frame;
  frame.cloud.points.resize(points, Eigen::Vector3f::Zero());
  return frame;
}

TrackedObject seenBy(int detection, bool dynamic)
{
  TrackedObject object;
  object.detection = detection;
  object.dynamic = dynamic;
  return object;
}

TEST(MovingPoints, NothingMovesWhereNothingWasSegmented)
{
  EXPECT_EQ(likelyMoving(frameOf(3), 0.5), std::vector<bool>(3, false));
}

TEST(MovingPoints, TheThresholdItselfStands)
{
  Frame frame = frameOf(3);
  frame.moving_probability = {0.25F, 0.5F, 0.75F};
  EXPECT_EQ(likelyMoving(frame, 0.5), (std::vector<bool>{false, false, true}));
  EXPECT_EQ(likelyMoving(frame, 0.1), (std::vector<bool>{true, true, true}));
}

TEST(MovingPoints, ThoseOfTrackedObjectsInMotionAreAdded)
{
  Frame frame = frameOf(5);
  frame.moving_probability = {0.9F, 0.0F, 0.0F, 0.0F, 0.0F};
  frame.detections.resize(2);
  frame.detections[0].points = {1, 2, 77};
  frame.detections[1].points = {3};
  frame.objects = {seenBy(0, true), seenBy(1, false), seenBy(-1, true), seenBy(9, true)};
  EXPECT_EQ(movingPoints(frame, 0.5), (std::vector<bool>{true, true, true, false, false}));
  EXPECT_EQ(likelyMoving(frame, 0.5), (std::vector<bool>{true, false, false, false, false}));
}
}  // namespace
}  // namespace dyslam
