// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/KittiConverter.h>
#include <dyslam/io/OptionError.h>
#include <dyslam/io/RecordingConverter.h>
#include <dyslam/io/ScanConverter.h>

#include <algorithm>

#include "BagWriters.h"
#include "ScanFolders.h"

namespace dyslam
{
TEST(RecordingConverter, DoesWhatTheConverterDoes)
{
  const TestFolder folder;
  writeBins(folder, "scans", 3);
  const RecordingConverter scans(folder.file("scans"));
  ASSERT_TRUE(scans.isNeeded());
  EXPECT_EQ("scans2rawlog", scans.program());
  RecordingOptions options;
  options.dt = 0.5;
  options.sensor_pose = "1 0 2 0 0 0";
  EXPECT_EQ(3U, scans.convert(folder.file("a.rawlog"), options).scans);
  ScanConverterOptions of_scans;
  of_scans.dt = 0.5;
  of_scans.sensor_pose = "1 0 2 0 0 0";
  (void)convertScans(folder.file("scans"), folder.file("b.rawlog"), of_scans);
  EXPECT_EQ(folder.read("b.rawlog"), folder.read("a.rawlog"));

  writeBins(folder, "sequences/00/velodyne", 3);
  const RecordingConverter kitti(folder.file("sequences/00"));
  EXPECT_EQ("kitti2rawlog --kind odometry", kitti.program());
  (void)kitti.convert(folder.file("a.rawlog"), options);
  KittiConverterOptions of_kitti;
  of_kitti.dt = 0.5;
  of_kitti.sensor_pose = "1 0 2 0 0 0";
  (void)convertKitti(folder.file("sequences/00"), folder.file("b.rawlog"), of_kitti);
  EXPECT_EQ(folder.read("b.rawlog"), folder.read("a.rawlog"));
  options.deskewed = ScansDeskewed::no;
  (void)kitti.convert(folder.file("a.rawlog"), options);
  EXPECT_NE(folder.read("b.rawlog"), folder.read("a.rawlog")) << "their times";
  of_kitti.deskewed = ScansDeskewed::no;
  (void)convertKitti(folder.file("sequences/00"), folder.file("b.rawlog"), of_kitti);
  EXPECT_EQ(folder.read("b.rawlog"), folder.read("a.rawlog"));
  options.vertical_angle_correction = true;
  (void)kitti.convert(folder.file("a.rawlog"), options);
  EXPECT_NE(folder.read("b.rawlog"), folder.read("a.rawlog")) << "their elevation";
  of_kitti.vertical_angle_correction = true;
  (void)convertKitti(folder.file("sequences/00"), folder.file("b.rawlog"), of_kitti);
  EXPECT_EQ(folder.read("b.rawlog"), folder.read("a.rawlog"));
  options.topic = "/points";
  EXPECT_EQ(
      "--topic works with a bag or topics of ROS 2 only",
      messageOfError<UserError>([&] { (void)kitti.convert(folder.file("a.rawlog"), options); }));
}

TEST(RecordingConverter, WhatIsNoRecording)
{
  const TestFolder folder;
  EXPECT_FALSE(RecordingConverter(folder.file("x.rawlog")).isNeeded());
  EXPECT_FALSE(RecordingConverter(folder.file("x")).isNeeded());
  EXPECT_TRUE(RecordingConverter(folder.file("x.bag")).isNeeded());
  const auto refusal = [&folder](const std::string& name)
  { return messageOfError<UserError>([&] { (void)RecordingConverter(folder.file(name)); }); };
  folder.write("pictures/1.png", "");
  EXPECT_TRUE(contains(
      refusal("pictures"),
      "pictures: is no rawlog, bag, capture or folder of scans: it has no .bin, .pcd, .ply"));
  writeBins(folder, "dataset/sequences/04/velodyne", 1);
  EXPECT_TRUE(contains(refusal("dataset"), "such as " + folder.file("dataset/sequences/04")));
  folder.write("rawlogs/a.rawlog", "");
  EXPECT_TRUE(contains(refusal("rawlogs"), "such as " + folder.file("rawlogs/a.rawlog")));

  folder.write("plain/velodyne/1.pcd", "");
  EXPECT_TRUE(contains(refusal("plain"), "such as " + folder.file("plain/velodyne")));

  for (const char* result : {"effective.ini", "report.json", "map_static.pcd"})
  {
    folder.write("out/run/" + std::string(result), "");
  }
  EXPECT_TRUE(contains(refusal("out/run"),
                       "out/run: is the output folder of a run; give its recording, which is"));
  EXPECT_FALSE(contains(refusal("out"), "such as"));
  folder.write("out/run/recording.rawlog", "");
  EXPECT_TRUE(contains(refusal("out/run"), folder.file("out/run/recording.rawlog")));

  const RecordingConverter single(folder.write("1.pcd", ""));
  ASSERT_TRUE(single.isNeeded());
  EXPECT_TRUE(contains(
      messageOfError<UserError>([&] { (void)single.convert(folder.file("a.rawlog"), {}); }),
      "is a single scan; give the folder of the scans"));
}

TEST(RecordingConverter, AnErrorThatAnOptionMendsSaysWhichOne)
{
  const TestFolder folder;
  const auto flagOf = [&folder](const std::string& input)
  {
    try
    {
      (void)RecordingConverter(folder.file(input)).convert(folder.file("a.rawlog"), {});
    }
    catch (const OptionError& error)
    {
      EXPECT_TRUE(contains(error.what(), error.flag())) << error.what();
      return error.flag();
    }
    return std::string();
  };
  writeBins(folder, "tracking/velodyne/0000", 1);
  writeBins(folder, "tracking/velodyne/0001", 1);
  EXPECT_EQ("--sequence", flagOf("tracking"));
  EXPECT_FALSE(RecordingOptions::hasFlag("--sequence"));
  test::writeBag(folder.file("imu.mcap"), {{"/imu", "sensor_msgs/Imu", 1, ""}});
  EXPECT_EQ("--list", flagOf("imu.mcap"));
}

TEST(RecordingOptions, OfEachTheFlagIsKnown)
{
  EXPECT_EQ("", RecordingOptions().givenFlag());
  RecordingOptions options;
  options.dt = 0.1;
  EXPECT_EQ("--dt", options.givenFlag());
  EXPECT_NO_THROW(options.requireFitting(RecordingKind::kitti));
  EXPECT_EQ("--dt: the scans of a bag and live ones have times; leave it out",
            messageOfError<UserError>([&] { options.requireFitting(RecordingKind::bag); }));
  options.base_frame = "base_link";
  EXPECT_EQ("--base-frame", options.givenFlag());
  EXPECT_EQ("--base-frame works with a bag or topics of ROS 2 only",
            messageOfError<UserError>([&] { options.requireFitting(RecordingKind::kitti); }));
  options.imu = true;
  const std::vector<std::string> words = options.words();
  EXPECT_EQ(1, std::count(words.begin(), words.end(), "--imu=true"));
  EXPECT_EQ("--imu", options.givenFlag());
  options.imu = false;
  options.sensor = "VLP16";
  EXPECT_EQ("--sensor", options.givenFlag());
  options.base_frame.clear();
  options.scale = 0.001;
  EXPECT_EQ("--scale=0.001", options.words().back());
  EXPECT_EQ("--scale works with a bag or a folder of scans only",
            messageOfError<UserError>([&] { options.requireFitting(RecordingKind::capture); }));
  options = {};
  options.bin_layout = "xyzi__";
  EXPECT_NO_THROW(options.requireFitting(RecordingKind::scans));
  options.bin_layout = "xyzw";
  EXPECT_NE(std::string::npos,
            messageOfError<UserError>([&] { options.requireFitting(RecordingKind::scans); })
                .find("--bin-layout xyzw: give a letter for each column"));
  options = {};
  options.deskewed = ScansDeskewed::no;
  EXPECT_EQ(std::vector<std::string>{"--deskewed=no"}, options.words());
  EXPECT_NO_THROW(options.requireFitting(RecordingKind::kitti));
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { options.requireFitting(RecordingKind::scans); }),
               "--deskewed works with KITTI's folders only"));
  options = {};
  options.vertical_angle_correction = true;
  EXPECT_EQ(std::vector<std::string>{"--kitti-vertical-angle-correction=true"}, options.words());
  EXPECT_EQ("--kitti-vertical-angle-correction works with KITTI's folders only",
            messageOfError<UserError>([&] { options.requireFitting(RecordingKind::scans); }));
  for (const char* flag : {"--dt", "--sensor", "--base-frame", "--imu", "--bin-layout", "--scale",
                           "--deskewed", "--kitti-vertical-angle-correction"})
  {
    EXPECT_TRUE(RecordingOptions::hasFlag(flag)) << flag;
  }
  EXPECT_FALSE(RecordingOptions::hasFlag("--list"));
}
}  // namespace dyslam
