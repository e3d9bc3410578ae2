// SPDX-License-Identifier: BSD-3-Clause
#include "../src/outputs/ScanLabels.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
/** Three points of a reported car, of which one does not move, and one point of nothing. */
Frame frameWithCar(int id)
{
  Frame frame;
  for (int i = 0; i < 4; ++i)
  {
    frame.scan.points.emplace_back(5 + i, 0, 0);
    frame.cloud.points.emplace_back(5 + i, 0, 0);
    frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
  }
  frame.moving = {true, true, false, false};
  Detection detection;
  detection.points = {0, 1, 2};
  frame.detections.push_back(detection);
  TrackedObject car;
  car.id = id;
  car.object_class = ObjectClass::car;
  car.detection = 0;
  car.reported = true;
  frame.objects.push_back(car);
  return frame;
}

TEST(ScanLabels, MovingPointsOfAnObjectHaveItsClassAndInstance)
{
  const std::vector<Label> labels = scanLabels(frameWithCar(41));
  EXPECT_EQ(labels, (std::vector<Label>{makeLabel(252, 42), makeLabel(252, 42), label_static,
                                        label_static}));
}

TEST(ScanLabels, InstancesBeginAgainAfterTheLastNumber)
{
  EXPECT_EQ(instanceOf(scanLabels(frameWithCar(65534)).front()), 65535);
  EXPECT_EQ(instanceOf(scanLabels(frameWithCar(65535)).front()), 1) << "0 would be none";
}
}  // namespace
}  // namespace dyslam
