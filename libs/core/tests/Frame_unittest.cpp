// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/Frame.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "SavedState.h"

namespace dyslam
{
namespace
{
Frame frameToSave()
{
  Frame frame;
  frame.index = 7;
  frame.scan.points = {{1, 2, 3}, {NAN, 5, 6}};
  frame.scan.ring = {3, 9};
  frame.scan.sensor_label = "lidar";
  frame.T_world_vehicle_truth = poseFromYpr(1, 2, 3, 0.1, 0.2, 0.3);
  frame.moving = {true, false, true};
  frame.moving_by_prediction = {false, false, true};
  frame.objects.resize(2);
  frame.objects[1].object_class = ObjectClass::truck;
  frame.objects[1].reported = true;
  frame.T_map_odom = poseFromYpr(3, 2, 1, 0.3, 0.2, 0.1);
  return frame;
}

TEST(Frame, PointsOfAnObjectAreThoseOfItsDetection)
{
  Frame frame;
  frame.detections.resize(2);
  frame.detections[1].points = {4, 7};
  TrackedObject object;
  EXPECT_TRUE(frame.pointsOf(object).empty()) << "not observed";
  object.detection = 1;
  EXPECT_EQ(&frame.pointsOf(object), &frame.detections[1].points);
}

TEST(FrameState, ComesBackWithAllFields)
{
  Frame frame = frameToSave();
  const std::string bytes = saved(frame);
  Frame again = loaded<Frame>(bytes);
  EXPECT_EQ(saved(again), bytes);
  EXPECT_EQ(again.scan.points[1].y(), 5);
  EXPECT_TRUE(std::isnan(again.scan.points[1].x()));
  EXPECT_EQ(again.T_world_vehicle_truth->matrix(), frame.T_world_vehicle_truth->matrix());
  EXPECT_EQ(again.objects[1].object_class, ObjectClass::truck);
  EXPECT_EQ(again.moving, frame.moving);
  EXPECT_EQ(again.moving_by_prediction, frame.moving_by_prediction);
  EXPECT_EQ(again.T_map_odom.matrix(), frame.T_map_odom.matrix());
}

TEST(FrameState, BytesThatEndEarlyAreAnError)
{
  Frame frame = frameToSave();
  const std::string bytes = saved(frame);
  for (std::size_t size = 0; size < bytes.size(); ++size)
  {
    const std::string part = bytes.substr(0, size);
    EXPECT_THROW((void)loaded<Frame>(part), UserError) << size;
  }
  EXPECT_THROW((void)loaded<Frame>(bytes + "x"), UserError);
}

TEST(FrameState, FieldsAreCounted)
{
  EXPECT_EQ(fields::count<Box>(), 3U);
  EXPECT_EQ(fields::count<MotionEstimate>(), 10U);
  EXPECT_EQ(fields::count<Frame>(), std::tuple_size_v<decltype(Frame().members())>);
}
}  // namespace
}  // namespace dyslam
