// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/SustechFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <cmath>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The camera looks along the lidar's x. */
Pose someMounting()
{
  Pose T_cam_velo = Pose::Identity();
  T_cam_velo.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  T_cam_velo.translation() = Eigen::Vector3d(0.05, -0.1, -0.3);
  return T_cam_velo;
}

const char* const mounting_rows = "0 -1 0 0.05 0 0 -1 -0.1 1 0 0 -0.3";
}  // namespace

TEST(KittiCalib, EachKindOfFile)
{
  const TestFolder folder;
  const std::string row = mounting_rows;
  const auto odometry =
      readKittiCalib(folder.write("o.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: " + row + "\n"));
  EXPECT_TRUE(odometry.T_cam_velo.isApprox(someMounting(), 1e-12));
  EXPECT_FALSE(odometry.has_imu);

  // Rectification turns about the camera's y by 90 degrees: its order matters.
  const auto tracking = readKittiCalib(folder.write(
      "t.txt", "P2: 7 0 6 4 0 7 1 0.2 0 0 1 0\nR_rect 0 0 1 0 1 0 -1 0 0\nTr_velo_cam " + row +
                   "\nTr_imu_velo 1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.8\n"));
  EXPECT_TRUE((tracking.T_cam_velo * Eigen::Vector3d(0.3, 0, -0.1))
                  .isApprox(Eigen::Vector3d(0, 0, -0.05), 1e-12));
  ASSERT_TRUE(tracking.has_imu);
  EXPECT_EQ(-0.8, tracking.T_velo_imu.translation().x());
  EXPECT_EQ(0.2, tracking.P2(1, 3));

  folder.write("raw/calib_cam_to_cam.txt",
               "calib_time: 09-Jan-2012 13:57:47\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
               "P_rect_02: 7 0 6 4 0 7 1 0.2 0 0 1 0\n");
  folder.write("raw/calib_velo_to_cam.txt",
               "calib_time: 15-Mar-2012 11:37:16\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0.05 -0.1 -0.3\n"
               "delta_f: 0 0\n");
  folder.write("raw/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
  const auto raw = readKittiCalib(folder.file("raw"));
  EXPECT_TRUE(raw.T_cam_velo.isApprox(someMounting(), 1e-12));
  EXPECT_TRUE(raw.has_imu);
}

TEST(KittiCalib, Errors)
{
  const TestFolder folder;
  EXPECT_THROW((void)readKittiCalib(folder.file("none")), UserError);
  const auto message = [&](const std::string& text)
  { return messageOfError<UserError>([&] { (void)readKittiCalib(folder.write("c.txt", text)); }); };
  EXPECT_TRUE(contains(message("P0: 1 2 3\n"), "has no R_rect"));
  EXPECT_TRUE(contains(message("Tr: 1 2 3\n"), "Tr has 3 numbers, needs 12"));
  EXPECT_TRUE(contains(message("Tr: 1 2 x\n"), "c.txt:1: 'x'"));
  const std::string of_zeros = "0 0 0 0 0 0 0 0 0 0 0 0\n";
  const std::string mirrored = "-1 0 0 0 0 1 0 0 0 0 1 0\n";
  EXPECT_TRUE(contains(message("Tr: " + of_zeros), "the matrix of Tr is not a rotation"));
  EXPECT_TRUE(contains(message("Tr: " + mirrored), "the matrix of Tr is not a rotation"));
  EXPECT_TRUE(contains(message("R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: " + of_zeros),
                       "the matrix of Tr_velo_to_cam is not a rotation"));
}

TEST(KittiBoxes, KnownCase)
{
  // Straight ahead of the camera, lengthwise along the view: ry = -90 degrees.
  const CameraBox camera{{0, 1.6, 20}, 1.5, 1.8, 4.0, -M_PI / 2};
  const Box box = toLidar(camera, someMounting());
  // The lidar is 0.3 m behind the camera and 0.1 m above; the centre is 0.85 m under the camera.
  EXPECT_TRUE(box.centre.isApprox(Eigen::Vector3d(20.3, 0.05, -0.95), 1e-12))
      << box.centre.transpose();
  EXPECT_EQ(Eigen::Vector3d(4.0, 1.8, 1.5), box.size);
  EXPECT_NEAR(0, box.yaw, 1e-12);
  // To the left of that is the camera's turn the other way, about its downward axis.
  for (const double yaw : {-3.0, -1.5, 0.7, 3.1})
  {
    CameraBox turned = camera;
    turned.ry = -M_PI / 2 - yaw;
    EXPECT_NEAR(yaw, toLidar(turned, someMounting()).yaw, 1e-12);
  }
}

TEST(KittiBoxes, TrackingFiles)
{
  const TestFolder folder;
  const std::string path = folder.write(
      "l.txt",
      "0 -1 DontCare -1 -1 -10 219.3 188.5 245.5 218.6 -1000 -1000 -1000 -10 -1 -1 -1\n"
      "3 7 Van 0 2 -1.79 296.7 161.8 455.2 292.4 2.0 1.8 4.4 -4.55 1.86 13.41 -2.12\n");
  const auto boxes = readKittiTracking(path, someMounting());
  ASSERT_EQ(1U, boxes.size());
  EXPECT_EQ(3, boxes[0].frame);
  EXPECT_EQ(7, boxes[0].id);
  EXPECT_EQ(ObjectClass::van, boxes[0].object_class);
  EXPECT_EQ(2, boxes[0].occluded);
  EXPECT_EQ(455.2, boxes[0].image_box[2]);
  EXPECT_EQ(2U, readKittiTracking(path, someMounting(), true).size());

  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)readKittiTracking(folder.write("b.txt", "\n1 2 Car\n"), someMounting()); }),
      "b.txt:2: has 3 fields"));
  const auto tooLarge = [&]
  {
    (void)readKittiTracking(folder.write("b.txt", "0 4e9 Car 0 0 0 1 2 3 4 1.5 1.8 4 0 1 20 0\n"),
                            someMounting());
  };
  EXPECT_TRUE(
      contains(messageOfError<UserError>(tooLarge), "b.txt:1: '4e9' is too large a number"));
}

TEST(KittiBoxes, Detections)
{
  const TestFolder folder;
  const auto boxes = readDetectionsCsv(
      folder.write("d.txt", "4,1,0,0,1,1,4.9,1.5,1.8,4.0,0,1.6,20,-1.5707963,0\n"), someMounting());
  ASSERT_EQ(1U, boxes.size());
  EXPECT_EQ(4, boxes[0].frame);
  EXPECT_EQ(ObjectClass::pedestrian, boxes[0].object_class);
  EXPECT_EQ(4.9, boxes[0].score);
  EXPECT_EQ(-1, boxes[0].id);
  EXPECT_TRUE(boxes[0].box.centre.isApprox(Eigen::Vector3d(20.3, 0.05, -0.95), 1e-9));
  EXPECT_EQ(Eigen::Vector3d(4.0, 1.8, 1.5), boxes[0].box.size);
  EXPECT_THROW(
      (void)readDetectionsCsv(folder.write("e.txt", "4,9,0,0,1,1,4.9,1.5,1.8,4.0,0,1.6,20,0,0\n"),
                              someMounting()),
      UserError);
}

TEST(KittiBoxes, SustechJson)
{
  const TestFolder folder;
  const std::string text =
      R"([{"obj_id": "12", "obj_type": "MotorcyleRider", "psr": {"position": {"x": 1, "y": 2,
      "z": 3}, "rotation": {"x": 0, "y": 0, "z": 6.5}, "scale": {"x": 2, "y": 0.8, "z": 1.7}}}])";
  const auto boxes = readSustechJson(folder.write("a.json", text), 9);
  ASSERT_EQ(1U, boxes.size());
  EXPECT_EQ(9, boxes[0].frame);
  EXPECT_EQ(12, boxes[0].id);
  EXPECT_EQ(ObjectClass::motorcyclist, boxes[0].object_class);
  EXPECT_NEAR(6.5 - 2 * M_PI, boxes[0].box.yaw, 1e-12);
  EXPECT_TRUE(readSustechJson(folder.write("b.json", "[]"), 0).empty());
  EXPECT_THROW((void)readSustechJson(folder.write("c.json", "[{]"), 0), UserError);
  EXPECT_THROW((void)readSustechJson(folder.write("d.json", "[{\"obj_id\": \"1\"}]"), 0),
               UserError);
}

TEST(KittiBoxes, JsonThatIsNestedDeeplyIsRefused)
{
  const TestFolder folder;
  const std::string deep(1000000, '[');
  for (const std::string& text :
       {deep, "[{\"obj_id\": " + deep + std::string(deep.size(), ']') + "}]"})
  {
    const std::string said =
        messageOfError<UserError>([&] { (void)readSustechJson(folder.write("a.json", text), 0); });
    EXPECT_TRUE(contains(said, "nested too deeply")) << said;
  }
}

TEST(KittiTimestamps, AreSecondsSince1970)
{
  const TestFolder folder;
  const auto times = readKittiTimestamps(folder.write(
      "t.txt", "1970-01-01 00:00:00.0\n2011-09-26 13:02:25.951199337\n2024-02-29 00:00:01.5\n"));
  ASSERT_EQ(3U, times.size());
  EXPECT_EQ(0, times[0]);
  EXPECT_NEAR(1317042145.951199, times[1], 1e-6);
  EXPECT_NEAR(1709164801.5, times[2], 1e-6);
  EXPECT_THROW((void)readKittiTimestamps(folder.write("u.txt", "2011-09-26\n")), UserError);
  for (const char* wrong : {"20119002-09-26 13:02:25.9", "2011-13-26 13:02:25.9",
                            "2011-09-32 13:02:25.9", "2011-09-26 24:02:25.9"})
  {
    EXPECT_THROW((void)readKittiTimestamps(folder.write("u.txt", wrong)), UserError) << wrong;
  }
}

TEST(KittiTimestamps, LostScansHaveNoTime)
{
  const TestFolder folder;
  const std::string text = "\n2011-09-26 13:02:25.5\r\n\r\n# lost\n2011-09-26 13:02:25.75\n \n\n";
  for (const auto& times : {readKittiTimestamps(folder.write("t.txt", text)),
                            readTimesOrTimestamps(folder.file("t.txt"))})
  {
    ASSERT_EQ(4U, times.size());
    EXPECT_TRUE(std::isnan(times[0]));
    EXPECT_NEAR(1317042145.5, times[1], 1e-6);
    EXPECT_TRUE(std::isnan(times[2]));
    EXPECT_NEAR(1317042145.75, times[3], 1e-6);
  }
  EXPECT_TRUE(readKittiTimestamps(folder.write("u.txt", "\n\n")).empty());
}

TEST(KittiOxts, FilesAndFolders)
{
  const TestFolder folder;
  const std::string rest = " 0 0 10 1 2 0 0 0 0 0 0 0 0 0 0 0 0 0.05 0 4 10 4 4 0\n";
  const std::string first = "49.0 8.4 110 0 0 0" + rest;
  const std::string second = "49.00001 8.4 110.5 0 0 1.5707963" + rest;
  const auto one = readOxts(folder.write("oxts.txt", first + second));
  folder.write("oxts/data/0000000000.txt", first);
  folder.write("oxts/data/0000000001.txt", second);
  const auto many = readOxts(folder.file("oxts"));
  ASSERT_EQ(2U, one.size());
  ASSERT_EQ(2U, many.size());
  EXPECT_EQ(one[1].latitude, many[1].latitude);
  EXPECT_EQ(0.05, one[0].position_accuracy);
  const auto poses = oxtsPoses(one);
  EXPECT_TRUE(poses[0].isApprox(Pose::Identity(), 0));
  // 1e-5 degrees of latitude are 1.113 m, to the left of a vehicle that heads east.
  EXPECT_NEAR(0, poses[1].translation().x(), 1e-6);
  EXPECT_NEAR(1.1132, poses[1].translation().y(), 1e-3);
  EXPECT_NEAR(0.5, poses[1].translation().z(), 1e-9);
  EXPECT_TRUE(oxtsPoses({}).empty());
  EXPECT_THROW((void)readOxts(folder.write("bad.txt", "1 2 3\n")), UserError);
  std::filesystem::create_directories(folder.file("empty"));
  EXPECT_THROW((void)readOxts(folder.file("empty")), UserError);
}

/** Fields as in KITTI's dataformat.txt: ax ay az are the 12th to 14th, wx wy wz the 18th to 20th.
 */
TEST(KittiOxts, AngularVelocityAndAcceleration)
{
  const TestFolder folder;
  std::string line = "49";
  for (int field = 2; field <= 30; ++field)
  {
    line += " " + std::to_string(field);
  }
  const OxtsReading reading = readOxts(folder.write("oxts.txt", line + "\n")).at(0);
  EXPECT_EQ(Eigen::Vector3d(12, 13, 14), reading.acceleration);
  EXPECT_EQ(Eigen::Vector3d(18, 19, 20), reading.angular_velocity);
}

TEST(KittiOxts, RealDriveGivesItsKnownPoses)
{
  DYSLAM_REQUIRE_DATA();
  const std::string folder = *realDataFolder() + "/kitti_raw_2011_09_26_drive_0005/";
  const auto calib = readKittiCalib(folder + "calib.txt");
  ASSERT_TRUE(calib.has_imu);
  const auto poses =
      posesOfMountedSensor(oxtsPoses(readOxts(folder + "oxts.txt")), calib.T_velo_imu.inverse());
  const auto known = readKittiPoses(folder + "poses_oxts_velo.txt");
  ASSERT_GE(poses.size(), known.size());
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    EXPECT_LT((poses[i].translation() - known[i].translation()).norm(), 1e-4) << i;
    EXPECT_LT(rotationAngle(poses[i].inverse() * known[i]), 1e-5) << i;
  }
}

TEST(KittiFiles, AllTrackingSequencesRead)
{
  DYSLAM_REQUIRE_DATA();
  const std::string folder = *realDataFolder() + "/kitti_tracking_training_text/";
  std::size_t boxes = 0;
  std::size_t detections = 0;
  for (int i = 0; i <= 20; ++i)
  {
    const std::string name = (i < 10 ? "000" : "00") + std::to_string(i) + ".txt";
    const auto calib = readKittiCalib(folder + "calib/" + name);
    EXPECT_TRUE(calib.has_imu);
    EXPECT_GT(oxtsPoses(readOxts(folder + "oxts/" + name)).size(), 70U);
    boxes += readKittiTracking(folder + "label_02/" + name, calib.T_cam_velo).size();
    detections += readDetectionsCsv(folder + "det_pointrcnn/Car/" + name, calib.T_cam_velo).size();
  }
  EXPECT_GT(boxes, 30000U);
  EXPECT_GT(detections, 10000U);
}
}  // namespace dyslam
