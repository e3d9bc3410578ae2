// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RecordingKind.h>
#include <gtest/gtest.h>

#include <string>

#include "TestFolder.h"

namespace dyslam
{
TEST(RecordingKinds, AdviceForRecordings)
{
  const TestFolder folder;
  EXPECT_EQ("is a ROS bag; make a rawlog of it first: scans2rawlog -i a/b.mcap -o b.rawlog",
            conversionAdvice("a/b.mcap"));
  EXPECT_EQ("is a network capture; make a rawlog of it first: scans2rawlog -i b.pcap -o b.rawlog",
            conversionAdvice("b.pcap"));
  EXPECT_EQ(
      "is a recording of Ouster's SDK, whose own format is not read; save its packets: ouster-cli "
      "source a/b.osf save b.pcap",
      conversionAdvice("a/b.osf"));
  EXPECT_EQ("", conversionAdvice("b.rawlog"));
  EXPECT_EQ("", conversionAdvice("none"));
  folder.write("scans/1.bin", "");
  EXPECT_TRUE(contains(conversionAdvice(folder.file("scans")), "scans2rawlog"));
  folder.write("run/map_static.pcd", "");
  folder.write("run/report.json", "{}");
  EXPECT_TRUE(contains(conversionAdvice(folder.file("run")), "is the output folder of a run"));
  folder.write("kitti/velodyne/1.bin", "");
  EXPECT_TRUE(contains(conversionAdvice(folder.file("kitti")), "kitti2rawlog --kind odometry"));
}

TEST(RecordingKinds, OfficialLayoutsOfKitti)
{
  const TestFolder folder;
  const auto kindOf = [&folder](const std::string& name)
  { return officialKittiKind(folder.file(name)); };
  folder.write("drive_sync/velodyne_points/data/1.bin", "");
  EXPECT_EQ(KittiKind::raw, kindOf("drive_sync"));
  const std::string drive = "data_3d_raw/2013_05_28_drive_0000_sync";
  folder.write(drive + "/velodyne_points/data/1.bin", "");
  EXPECT_EQ(KittiKind::kitti360, kindOf(drive));
  EXPECT_EQ(KittiKind::kitti360, kittiKindOf(folder.file(drive + "/")));
  EXPECT_FALSE(kindOf("data_3d_raw"));
  EXPECT_TRUE(contains(conversionAdvice(folder.file(drive)), "kitti2rawlog --kind 360 -i"));
  folder.write("testing/velodyne/0000/1.bin", "");
  EXPECT_EQ(KittiKind::tracking, kindOf("testing"));
  folder.write("sequences/00/velodyne/1.bin", "");
  EXPECT_EQ(KittiKind::odometry, kindOf("sequences/00"));
  folder.write("plain/velodyne/1.bin", "");
  EXPECT_FALSE(kindOf("plain"));
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("plain")));
  EXPECT_FALSE(kittiKindOf(folder.file("sequences")));
  const WorkingFolder within(folder.file("sequences"));
  EXPECT_EQ(KittiKind::odometry, officialKittiKind("00"));
  EXPECT_EQ(KittiKind::odometry, officialKittiKind("00/"));
  const WorkingFolder deeper("00");
  EXPECT_EQ(KittiKind::odometry, officialKittiKind("."));
}

TEST(RecordingKinds, KindsOfRecordings)
{
  const TestFolder folder;
  const auto kindOf = [&folder](const std::string& name)
  { return recordingKind(folder.file(name)); };
  EXPECT_EQ(RecordingKind::bag, kindOf("a.db3"));
  EXPECT_EQ(RecordingKind::capture, kindOf("A.PCAPNG"));
  EXPECT_EQ(RecordingKind::capture, kindOf("a.pcapng.gz"));
  EXPECT_EQ(RecordingKind::bag, kindOf("a.mcap.zst"));
  EXPECT_EQ(RecordingKind::unknown, kindOf("a.rawlog.gz"));
  EXPECT_EQ(RecordingKind::unknown, kindOf("a.rawlog"));
  EXPECT_EQ(RecordingKind::network, recordingKind("udp:2368"));
  EXPECT_EQ(RecordingKind::unknown, kindOf("udp"));
  EXPECT_EQ(RecordingKind::unknown, kindOf("a.pcd"));
  folder.write("recording/metadata.yaml", "");
  EXPECT_EQ(RecordingKind::unknown, kindOf("recording"));
  folder.write("recording/recording_0.mcap", "");
  EXPECT_EQ(RecordingKind::bag, kindOf("recording"));
  folder.write("scans/1.pcd", "");
  EXPECT_EQ(RecordingKind::scans, kindOf("scans"));
  folder.write("drive_sync/velodyne_points/data/1.bin", "");
  EXPECT_EQ(RecordingKind::kitti, kindOf("drive_sync"));
  EXPECT_EQ(KittiKind::raw, kittiKindOf(folder.file("drive_sync")));
  folder.write("plain/velodyne/1.bin", "");
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("plain")));
  folder.write("plain/oxts.txt", "");
  EXPECT_EQ(KittiKind::raw, kittiKindOf(folder.file("plain")));
  folder.write("sequences/00/velodyne/1.bin", "");
  folder.write("sequences/00/oxts.txt", "");
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("sequences/00")));
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("sequences/00/")));
  folder.write("testing/velodyne/0000/1.bin", "");
  EXPECT_EQ(KittiKind::tracking, kittiKindOf(folder.file("testing")));
  folder.write("pcd/velodyne/1.pcd", "");
  folder.write("pcd/oxts.txt", "");
  EXPECT_EQ(RecordingKind::unknown, kindOf("pcd"));
  EXPECT_EQ(RecordingKind::scans, kindOf("pcd/velodyne"));
  folder.write("pcd/velodyne/1.bin", "");
  EXPECT_EQ(KittiKind::raw, kittiKindOf(folder.file("pcd")));
}
}  // namespace dyslam
