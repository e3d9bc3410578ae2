// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/KittiTracks.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The camera looks along the lidar's x and is tilted by a degree. */
Pose tiltedMounting()
{
  Pose T_cam_velo = Pose::Identity();
  T_cam_velo.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  T_cam_velo.linear() = poseFromYpr(0, 0, 0, 0.005, -0.01, 0.017).linear() * T_cam_velo.linear();
  T_cam_velo.translation() = Eigen::Vector3d(0.05, -0.1, -0.3);
  return T_cam_velo;
}

const std::string columns = " 0 0 0.3 100 150 200 250 1.5 1.8 4.0 0.5 1.6 20 -1.5";

std::string errorOf(const TestFolder& folder, const std::string& text)
{
  return messageOfError<UserError>(
      [&] { (void)readDetections(folder.write("e.txt", text), tiltedMounting()); });
}
}  // namespace

TEST(KittiTracks, CameraBoxIsTheInverse)
{
  const Pose T = tiltedMounting();
  for (const double ry : {-3.1, -1.6, -0.4, 0.0, 1.2, 2.9})
  {
    const CameraBox camera{{2, 1.6, 15}, 1.5, 1.8, 4.0, ry};
    const CameraBox again = toCamera(toLidar(camera, T), T);
    EXPECT_NEAR((again.bottom - camera.bottom).norm(), 0, 1e-12);
    EXPECT_EQ(again.height, camera.height);
    EXPECT_EQ(again.width, camera.width);
    EXPECT_EQ(again.length, camera.length);
    EXPECT_NEAR(again.ry, ry, 1e-12);
  }
}

TEST(KittiTracks, EveryLayoutOfDetectionsIsTheSameBox)
{
  const TestFolder folder;
  const Pose T = tiltedMounting();
  const auto csv = readDetections(
      folder.write("a.txt", "3,2,100,150,200,250,7.5,1.5,1.8,4.0,0.5,1.6,20,-1.5,0.3\n"), T);
  const auto with_id = readDetections(folder.write("b.txt", "3 9 Car" + columns + " 7.5\n"), T);
  const auto without_id = readDetections(folder.write("c.txt", "3 Car" + columns + " 7.5\n"), T);
  for (const auto* boxes : {&csv, &with_id, &without_id})
  {
    ASSERT_EQ(boxes->size(), 1u);
    const LabelledBox& box = boxes->front();
    EXPECT_EQ(box.frame, 3);
    EXPECT_EQ(box.type, "Car");
    EXPECT_EQ(box.object_class, ObjectClass::car);
    EXPECT_EQ(box.score, 7.5);
    EXPECT_EQ(box.image_box, Eigen::Vector4d(100, 150, 200, 250));
    EXPECT_TRUE(box.box.centre.isApprox(csv[0].box.centre, 1e-12));
    EXPECT_EQ(box.box.size, Eigen::Vector3d(4.0, 1.8, 1.5));
    EXPECT_NEAR(box.box.yaw, csv[0].box.yaw, 1e-12);
  }
  EXPECT_EQ(with_id[0].id, 9);
  EXPECT_EQ(without_id[0].id, -1);
  EXPECT_TRUE(readDetections(folder.write("none.txt", ""), T).empty());
  EXPECT_TRUE(readDetections(folder.write("d.txt", "0 DontCare" + columns + " 1\n"), T).empty());
}

TEST(KittiTracks, OtherLayoutsAreErrorsOfOneLine)
{
  const TestFolder folder;
  EXPECT_NE(errorOf(folder, "3 9 Car" + columns + "\n").find("e.txt:1: has no score"),
            std::string::npos);
  EXPECT_NE(errorOf(folder, "1 2 3\n").find("e.txt:1: has 3 fields in no known order"),
            std::string::npos);
  EXPECT_NE(errorOf(folder, "3 Car" + columns + " 7.5\n4 Car 1\n").find("e.txt:2: has 3 fields"),
            std::string::npos);
  EXPECT_NE(errorOf(folder, "3 9 Car" + columns + " high\n").find("e.txt:1: 'high'"),
            std::string::npos);
}

TEST(KittiTracks, WrittenTracksReadBack)
{
  const TestFolder folder;
  const Pose T = tiltedMounting();
  std::vector<LabelledBox> boxes;
  for (int i = 0; i < 5; ++i)
  {
    LabelledBox box;
    box.frame = i / 2;
    box.id = i;
    box.object_class = i % 2 == 0 ? ObjectClass::pedestrian : ObjectClass::cyclist;
    box.box.centre = {12.3456789 + i, -3.21 * i, -0.9};
    box.box.size = {0.8, 0.61234567, 1.7};
    box.box.yaw = -3 + 1.3 * i;
    box.score = 3.3333333333 - i;
    box.image_box = {1.5, 2.25, 300.125, 44};
    boxes.push_back(box);
  }
  const std::string path = folder.file("t.txt");
  writeKittiTracks(path, boxes, T);
  std::ifstream file(path);
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  // Programs of others split at single spaces.
  EXPECT_EQ(std::count(line.begin(), line.end(), ' '), 17);
  EXPECT_EQ(line.rfind("0 0 Pedestrian 0 0 ", 0), 0u) << line;
  const auto again = readDetections(path, T);
  ASSERT_EQ(again.size(), boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
  {
    EXPECT_EQ(again[i].frame, boxes[i].frame);
    EXPECT_EQ(again[i].id, boxes[i].id);
    EXPECT_EQ(again[i].object_class, boxes[i].object_class);
    EXPECT_NEAR((again[i].box.centre - boxes[i].box.centre).norm(), 0, 1e-9);
    EXPECT_NEAR((again[i].box.size - boxes[i].box.size).norm(), 0, 1e-9);
    EXPECT_NEAR(std::remainder(again[i].box.yaw - boxes[i].box.yaw, 2 * M_PI), 0, 1e-9);
    EXPECT_NEAR(again[i].score, boxes[i].score, 1e-9);
    EXPECT_EQ(again[i].image_box, boxes[i].image_box);
  }
}

TEST(KittiTracks, TypesOfSeveralWordsTakeOneColumn)
{
  const TestFolder folder;
  LabelledBox box;
  box.type = "Scooter Rider";
  box.box.size = {2, 1, 1.7};
  writeKittiTracks(folder.file("t.txt"), {box}, tiltedMounting());
  const auto again = readDetections(folder.file("t.txt"), tiltedMounting());
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].type, "Scooter_Rider");
}
}  // namespace dyslam
