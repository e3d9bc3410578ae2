// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapping/LabelledMap.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace dyslam
{
namespace
{
Frame frameOf(const std::vector<Eigen::Vector3f>& points, const Pose& T = Pose::Identity())
{
  Frame frame;
  frame.cloud.points = points;
  frame.T_odom_vehicle = T;
  return frame;
}

TEST(LabelledMap, HasOnePointOfEachCube)
{
  LabelledMap map;
  map.add(frameOf({{1.01F, 0.01F, 0}, {1.04F, 0.03F, 0}, {1.21F, 0.01F, 0}}),
          {label_static, label_static, label_moving});
  ASSERT_EQ(2U, map.points().size());
  EXPECT_EQ(Eigen::Vector3f(1.01F, 0.01F, 0), map.points()[0]);
  EXPECT_EQ((std::vector<Label>{label_static, label_moving}), map.labels());
}

TEST(LabelledMap, WhatWasEverStaticIsStatic)
{
  LabelledMap map;
  const Frame frame = frameOf({{1.01F, 0, 0}});
  map.add(frame, {label_moving});
  EXPECT_EQ(label_moving, map.labels().at(0));
  map.add(frame, {label_static});
  map.add(frame, {label_moving});
  EXPECT_EQ(label_static, map.labels().at(0));
}

TEST(LabelledMap, PointsAreInTheMapFrameAndIgnoredOnesLeftOut)
{
  LabelledMap map;
  map.add(frameOf({{1, 0, 0}, {5, 0, 0}}, poseFromYpr(10, 0, 0, M_PI_2, 0, 0)), {label_static, 0});
  ASSERT_EQ(1U, map.points().size());
  EXPECT_TRUE(map.points()[0].isApprox(Eigen::Vector3f(10, 1, 0), 1e-5F));
}

TEST(LabelledMap, WithoutLabelsObjectsMoveAndTheGroundBelowThemDoesNot)
{
  Frame frame = frameOf({{5, 0, 0.1F}, {5, 0, 1}, {5, 1.05F, 1}, {5, 1.2F, 1}, {20, 0, 1}});
  TrackedObject car;
  car.box.centre = {5, 0, 0.75};
  car.box.size = {4, 2, 1.5};
  car.dynamic = true;
  frame.objects = {car};
  car.box.centre.x() = 20;
  car.dynamic = false;
  frame.objects.push_back(car);
  LabelledMap map;
  map.add(frame, {});
  EXPECT_EQ(
      (std::vector<Label>{label_static, label_moving, label_moving, label_static, label_static}),
      map.labels());
}

TEST(LabelledMap, AnotherNumberOfLabelsIsRefused)
{
  LabelledMap map;
  EXPECT_THROW(map.add(frameOf({{1, 0, 0}}), {label_static, label_static}), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam
