// SPDX-License-Identifier: BSD-3-Clause
// What cannot be exported as a bag, and what the user is told.
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/BagExport.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "ExportedRun.h"
#include "FullDisk.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::bag_scans;
using test::exportError;
using test::runPose;
using test::timedScan;
using test::topicMessages;
using test::writeRun;
using test::writeSensors;
}  // namespace

TEST(BagExportProblems, ScansWithoutAPoseAreSaid)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options;
  Trajectory poses;
  poses.push_back(timedScan(0).stamp, runPose(0));
  poses.push_back(timedScan(1).stamp, runPose(1));
  writeTum(folder.file("two.txt"), poses);
  options.trajectory = folder.file("two.txt");
  const auto result = exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), options);
  EXPECT_EQ(2U, result.poses);
  EXPECT_EQ(2U, topicMessages(folder.file("x.mcap"), "/tf").data.size());
  EXPECT_EQ(bag_scans, topicMessages(folder.file("x.mcap"), "/points").data.size());
  EXPECT_TRUE(hasLine(result.warnings, "two.txt: has no pose for 2 of 4 scans"));
  EXPECT_TRUE(hasLine(result.warnings,
                      "(scans: 1600000000.000 to 1600000000.300 s, "
                      "poses: 1600000000.000 to 1600000000.100 s)"));

  Trajectory other;
  other.push_back(5, runPose(0));
  other.push_back(6, runPose(1));
  writeTum(folder.file("other.txt"), other);
  options.trajectory = folder.file("other.txt");
  const std::string none = exportError(folder, options);
  EXPECT_TRUE(contains(none, "other.txt: has no pose for any scan"));
  EXPECT_TRUE(contains(none, "poses: 5.000 to 6.000 s)")) << none;
  EXPECT_FALSE(std::filesystem::exists(folder.file("y.mcap")));
}

TEST(BagExportProblems, WhatDoesNotFitIsSaid)
{
  const TestFolder folder;
  writeSensors(folder);
  const BagExportOptions run = writeRun(folder);
  EXPECT_TRUE(contains(exportError(folder, run, "y.bag"), "y.bag: name the bag to write *.mcap"));
  BagExportOptions options;
  options.tracks = run.tracks;
  EXPECT_TRUE(contains(exportError(folder, options), "give --trajectory"));
  options = {};
  options.map = run.map;
  EXPECT_TRUE(contains(exportError(folder, options), "--map " + run.map));
  options = {};
  options.static_only = true;
  EXPECT_TRUE(contains(exportError(folder, options), "--static-only: needs labels"));
  options.labels = run.labels;
  options.no_scans = true;
  EXPECT_TRUE(contains(exportError(folder, options), "--no-scans leaves all out"));
  options = {};
  options.trajectory = folder.file("kitti.txt");
  writeKittiPoses(options.trajectory, std::vector<Pose>{runPose(0)});
  EXPECT_TRUE(contains(exportError(folder, options), "kitti.txt: has no times"));
  options = {};
  options.labels = folder.path();
  EXPECT_TRUE(contains(exportError(folder, options), "is not a folder of .label files"));
  options.labels = folder.file("run");
  std::filesystem::remove(folder.file("run/labels/000002.label"));
  const std::string unlabelled = exportError(folder, options);
  EXPECT_TRUE(contains(unlabelled, "000002.label: no such file, but scan 2"));
  EXPECT_TRUE(contains(unlabelled, "(--only-first-n 2)")) << unlabelled;
  options.source.skip_first_n = 1;
  EXPECT_TRUE(contains(exportError(folder, options), "(--skip-first-n 1 --only-first-n 1)"));
  options.source.skip_first_n = 2;
  EXPECT_TRUE(contains(exportError(folder, options), "(--skip-first-n, --only-first-n)"));
  options = {};
  options.source.skip_first_n = 9;
  EXPECT_TRUE(contains(exportError(folder, options), "skip_first_n = 9: no scan is left"));
}

TEST(BagExportProblems, PosesThatRosDoesNotHoldNameTheirFile)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options;
  Trajectory poses;
  poses.push_back(-0.05, runPose(0));
  poses.push_back(timedScan(0).stamp, runPose(0));
  writeTum(folder.file("early.txt"), poses);
  options.trajectory = folder.file("early.txt");
  EXPECT_TRUE(
      contains(exportError(folder, options),
               folder.file("early.txt") + ": the time stamp -0.050 s is none that ROS 2 holds"));
}

TEST(BagExportProblems, ADiskThatIsFullIsNoFaultOfTheMap)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options = writeRun(folder);
  // More than a chunk, so that the map is written at once.
  std::vector<Eigen::Vector3f> points(500000);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    points[i] = {static_cast<float>(i), std::sin(static_cast<float>(i)), 1};
  }
  writePcd(options.map, points, std::vector<float>(points.size(), 0.5F));
  const test::FullDisk disk(10000);
  const std::string error = exportError(folder, options);
  EXPECT_EQ(0U, error.find(folder.file("y.mcap") + ": cannot be written")) << error;
  EXPECT_FALSE(contains(error, "--no-map")) << error;
}

TEST(BagExportProblems, AfterDamageTheScansBeforeCanBeChosen)
{
  const TestFolder folder;
  RawlogWriter writer(folder.file("whole.rawlog"));
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    writer.write(timedScan(i), somePose(i));
  }
  writer.close();
  const std::string whole = folder.read("whole.rawlog");
  folder.write("x.rawlog", whole.substr(0, whole.size() - 16));
  BagExportOptions options;
  options.source.skip_first_n = 1;
  const std::string error = exportError(folder, options);
  EXPECT_TRUE(contains(error, "is cut short")) << error;
  const std::string advice = "; the scans before it can be written with --skip-first-n 1 ";
  ASSERT_TRUE(contains(error, advice + "--only-first-n 2")) << error;
  options.source.only_first_n = 2;
  EXPECT_EQ(2U, exportBag(folder.file("x.rawlog"), folder.file("y.mcap"), options).scans);
}

TEST(BagExportProblems, NothingOfOthersIsTouchedAndNothingHalfStays)
{
  const TestFolder folder;
  writeSensors(folder);
  folder.write("y.mcap", "earlier");
  EXPECT_TRUE(contains(exportError(folder, {}), "y.mcap: is there already"));
  BagExportOptions options;
  options.force = true;
  const auto stop = [](double, std::size_t scans)
  {
    if (scans == 2)
    {
      throw std::runtime_error("stop");
    }
  };
  EXPECT_THROW((void)exportBag(folder.file("x.rawlog"), folder.file("y.mcap"), options, stop),
               std::runtime_error);
  EXPECT_EQ("earlier", folder.read("y.mcap"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("y.mcap.tmp")));
  (void)exportBag(folder.file("x.rawlog"), folder.file("y.mcap"), options);
  EXPECT_EQ(bag_scans, topicMessages(folder.file("y.mcap"), "/points").data.size());
}
}  // namespace dyslam
