// SPDX-License-Identifier: BSD-3-Clause
#include "../src/GivenBoxes.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "../src/DetectorClasses.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** A point on a car 10 m ahead, 1 m to the left, one on the road below it, one elsewhere. */
Frame frameWithCar(std::size_t index)
{
  Frame frame;
  frame.index = index;
  frame.scan.T_vehicle_lidar.translation() = Eigen::Vector3d(0.5, 0, 1.7);
  frame.cloud.points = {{10.5F, 1, 1}, {10.5F, 1, 0.05F}, {3, 3, 1}};
  return frame;
}

class GivenBoxesFile : public ::testing::Test
{
 protected:
  [[nodiscard]] GivenBoxes read(const std::string& name) const
  {
    GivenBoxesOptions options;
    options.file = folder_.file(name);
    options.calib = calib_.empty() ? "" : folder_.file(calib_);
    options.min_score = min_score_;
    return GivenBoxes(options, DetectionNoiseOptions());
  }
  [[nodiscard]] std::string errorOf(const std::string& name) const
  {
    return messageOfError<UserError>([&] { (void)read(name); });
  }

  TestFolder folder_;
  std::string calib_;
  double min_score_ = -1e6;
};

TEST_F(GivenBoxesFile, AreDetectionsWithTheirPoints)
{
  folder_.write("boxes.txt",
                "2 -1 Car 0 0 -10 0 0 0 0 1.5 1.8 4.2 10 1 -0.95 0.1 0.7\n"
                "2 -1 DontCare 0 0 -10 0 0 0 0 1 1 1 5 5 0 0 0.9\n"
                "2 -1 Pedestrian 0 0 -10 0 0 0 0 1.7 0.6 0.6 20 5 -0.8 0 0.2\n"
                "2 -1 Car 0 0 -10 0 0 0 0 1.5 0 4.2 30 1 -0.95 0.1 0.7\n"
                "4 -1 Cyclist 0 0 -10 0 0 0 0 1.7 0.6 1.6 20 5 -0.8 0 0.9\n");
  min_score_ = 0.3;
  const GivenBoxes boxes = read("boxes.txt");
  Frame frame = frameWithCar(2);
  frame.detections.resize(3);
  boxes.detect(frame);
  ASSERT_EQ(1U, frame.detections.size());
  const Detection& car = frame.detections[0];
  EXPECT_TRUE(car.external);
  EXPECT_EQ(ObjectClass::car, car.object_class);
  EXPECT_EQ(0.7, car.score);
  EXPECT_TRUE(car.box.centre.isApprox(Eigen::Vector3d(10.5, 1, 0.75), 1e-9)) << "vehicle frame";
  EXPECT_TRUE(car.box.size.isApprox(Eigen::Vector3d(4.2, 1.8, 1.5)));
  EXPECT_NEAR(0.1, car.box.yaw, 1e-9);
  EXPECT_EQ(std::vector<std::uint32_t>{0}, car.points);
  EXPECT_GT(car.covariance(0, 0), car.covariance(1, 1)) << "less certain along the line of sight";
  frame = frameWithCar(3);
  boxes.detect(frame);
  EXPECT_TRUE(frame.detections.empty());
}

/** Names of KITTI, nuScenes, Waymo and Autoware. */
TEST(DetectorClasses, OfCommonDetectors)
{
  const std::vector<std::pair<ObjectClass, std::vector<std::string>>> known{
      {ObjectClass::car,
       {"Car", "car", "CAR", "vehicle.car", "TYPE_VEHICLE", "Vehicle", "vehicle.emergency.police"}},
      {ObjectClass::van, {"Van"}},
      {ObjectClass::truck,
       {"truck", "TRUCK", "vehicle.truck", "trailer", "TRAILER", "vehicle.trailer",
        "construction_vehicle", "vehicle.construction"}},
      {ObjectClass::bus, {"bus", "BUS", "vehicle.bus.rigid", "vehicle.bus.bendy"}},
      {ObjectClass::motorcyclist, {"motorcycle", "MOTORCYCLE", "vehicle.motorcycle"}},
      {ObjectClass::cyclist, {"bicycle", "BICYCLE", "vehicle.bicycle", "Cyclist", "TYPE_CYCLIST"}},
      {ObjectClass::pedestrian,
       {"pedestrian", "Pedestrian", "PEDESTRIAN", "TYPE_PEDESTRIAN", "Person_sitting",
        "human.pedestrian.adult", "human.pedestrian.construction_worker"}},
      {ObjectClass::unknown,
       {"Misc", "Tram", "animal", "movable_object.debris", "TYPE_UNKNOWN", "", ".", "type_"}}};
  for (const auto& [object_class, names] : known)
  {
    for (const std::string& name : names)
    {
      const auto found = classFromDetector(name);
      ASSERT_TRUE(found) << name;
      EXPECT_EQ(object_class, *found) << name;
    }
  }
  for (const char* name : {"traffic_cone", "barrier", "movable_object.trafficcone", "TYPE_SIGN",
                           "movable_object.barrier", "static_object.bicycle_rack"})
  {
    EXPECT_FALSE(classFromDetector(name)) << name;
  }
}

TEST_F(GivenBoxesFile, MayBeOfThingsThatCannotMove)
{
  const std::string place = " 0 0 -10 0 0 0 0 1.5 0.6 0.6 10 1 -0.95 0.1 0.7\n";
  folder_.write("none.txt", "2 -1 bicycle" + place);
  EXPECT_TRUE(read("none.txt").warnings().empty());
  folder_.write("one.txt", "2 -1 bicycle" + place + "2 -1 barrier" + place);
  using Warnings = std::vector<std::string>;
  EXPECT_EQ(Warnings{"boxes.file: left out 1 detection of things that cannot move (barrier)"},
            read("one.txt").warnings());
  folder_.write("boxes.txt", "2 -1 traffic_cone" + place + "2 -1 bicycle" + place + "2 -1 barrier" +
                                 place + "3 -1 barrier" + place);
  const GivenBoxes boxes = read("boxes.txt");
  EXPECT_EQ(
      Warnings{
          "boxes.file: left out 3 detections of things that cannot move (barrier, traffic_cone)"},
      boxes.warnings());
  Frame frame = frameWithCar(2);
  boxes.detect(frame);
  ASSERT_EQ(1U, frame.detections.size());
  EXPECT_EQ(ObjectClass::cyclist, frame.detections[0].object_class);
  folder_.write("cones.txt", "2 -1 traffic_cone" + place);
  EXPECT_NE(errorOf("cones.txt").find("has no boxes of things that can move"), std::string::npos)
      << errorOf("cones.txt");
}

TEST_F(GivenBoxesFile, OfDynamicObjectsMove)
{
  folder_.write("boxes.txt", "2 -1 Car 0 0 -10 0 0 0 0 1.5 1.8 4.2 10 1 -0.95 0.1 0.7\n");
  Frame frame = frameWithCar(2);
  read("boxes.txt").detect(frame);
  TrackedObject car;
  car.detection = 0;
  car.confirmed = true;
  frame.objects = {car};
  GivenBoxes::markMoving(frame);
  EXPECT_FALSE(frame.isMoving(0)) << "a parked one";
  frame.objects[0].dynamic = true;
  GivenBoxes::markMoving(frame);
  EXPECT_TRUE(frame.isMoving(0));
  EXPECT_FALSE(frame.isMoving(1)) << "outside the box";
  EXPECT_GT(frame.moving_probability.at(0), 0.5F);
}

/** The same boxes in the camera frame: one file, or one for each scan. */
TEST_F(GivenBoxesFile, MayBeInTheCameraFrame)
{
  // The camera is where the lidar is: z forward, x to the right, y down.
  folder_.write("calib.txt",
                "P2: 1 0 0 0 0 1 0 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
                "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  const std::string box = "0 0 -10 0 0 0 0 1.5 1.8 4.2 -1 1.7 10 -1.5708 0.7\n";
  folder_.write("boxes.txt", "2 -1 Car " + box);
  std::filesystem::create_directories(folder_.file("boxes"));
  folder_.write("boxes/000002.txt", "Car " + box);
  folder_.write("boxes/000003.txt", "");
  folder_.write("boxes/readme.txt", "no boxes");
  calib_ = "calib.txt";
  for (const std::string name : {"boxes.txt", "boxes"})
  {
    Frame frame = frameWithCar(2);
    read(name).detect(frame);
    ASSERT_EQ(1U, frame.detections.size()) << name;
    const Box& found = frame.detections[0].box;
    EXPECT_TRUE(found.centre.isApprox(Eigen::Vector3d(10.5, 1, 0.75), 1e-6)) << name;
    EXPECT_NEAR(0, found.yaw, 1e-4) << name;
    EXPECT_TRUE(read(name).warnings().empty()) << name;
  }
  calib_.clear();  // forgotten
  const std::vector<std::string> warnings = read("boxes.txt").warnings();
  ASSERT_EQ(1U, warnings.size());
  EXPECT_NE(warnings[0].find("boxes.calib is needed"), std::string::npos) << warnings[0];
}

TEST_F(GivenBoxesFile, Errors)
{
  EXPECT_NE(errorOf("none.txt").find("none.txt"), std::string::npos) << errorOf("none.txt");
  std::filesystem::create_directories(folder_.file("empty"));
  EXPECT_NE(errorOf("empty").find("has no NNNNNN.txt"), std::string::npos) << errorOf("empty");
  folder_.write("short.txt", "2 -1 Car 0 0\n");
  EXPECT_NE(errorOf("short.txt").find("short.txt:1"), std::string::npos) << errorOf("short.txt");
  EXPECT_EQ(0U, errorOf("short.txt").rfind("boxes.file: ", 0)) << errorOf("short.txt");
  std::filesystem::create_directories(folder_.file("bad"));
  folder_.write("bad/000007.txt", "Car 0 0 -10\n");
  EXPECT_NE(errorOf("bad").find("000007.txt:1"), std::string::npos) << errorOf("bad");
  EXPECT_EQ(0U, errorOf("bad").rfind("boxes.file: ", 0)) << errorOf("bad");
  folder_.write("bad/7.txt", "");
  EXPECT_NE(errorOf("bad").find("7.txt: is of the same scan as"), std::string::npos)
      << errorOf("bad");
  folder_.write("flat.txt", "2 -1 Car 0 0 -10 0 0 0 0 1.5 -1.8 4.2 10 1 -0.95 0.1\n");
  EXPECT_NE(errorOf("flat.txt").find("length above 0"), std::string::npos) << errorOf("flat.txt");
  folder_.write("weak.txt", "2 -1 Car 0 0 -10 0 0 0 0 1.5 1.8 4.2 10 1 -0.95 0.1 0.7\n");
  min_score_ = 0.8;
  EXPECT_NE(errorOf("weak.txt").find("boxes.min_score"), std::string::npos) << errorOf("weak.txt");
  folder_.write("calib.txt", "P2: 1 0 0\n");
  calib_ = "calib.txt";
  EXPECT_EQ(0U, errorOf("weak.txt").rfind("boxes.calib: ", 0)) << errorOf("weak.txt");
}
}  // namespace
}  // namespace dyslam
