// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/mapbuilder/MapBuilder.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "TestFolder.h"
#include "TestRecording.h"

namespace dyslam
{
namespace
{
MapBuilderOptions plainOptions()
{
  MapBuilderOptions options;
  options.threads = 1;
  options.hindsight.hindsight = false;
  options.map.visibility = false;
  return options;
}

void addDrive(MapBuilder& builder, const Trajectory& trajectory)
{
  for (std::size_t i = 0; i < trajectory.size(); ++i)
  {
    builder.add(test::frameFrom(trajectory[i].pose, i));
  }
}

std::size_t keyframesOf(const MapBuilderOptions& options, const Trajectory& trajectory)
{
  MapBuilder builder(options);
  builder.beginRun(trajectory, test::asRecorded());
  addDrive(builder, trajectory);
  builder.finish();
  return builder.keyframes();
}

TEST(MapBuilder, KeyframesAreChosenByDistance)
{
  const Trajectory drive = test::straightDrive(11, 0.4);
  MapBuilderOptions options = plainOptions();
  EXPECT_EQ(4U, keyframesOf(options, drive));  // 0, 1.2, 2.4, 3.6 m
  options.keyframe_distance = 2;
  EXPECT_EQ(3U, keyframesOf(options, drive));
  options.keyframe_distance = 0;
  EXPECT_EQ(11U, keyframesOf(options, drive));
}

TEST(MapBuilder, AndByTurn)
{
  Trajectory turn;
  for (std::size_t i = 0; i < 9; ++i)
  {
    turn.push_back(test::start_time + test::period * static_cast<double>(i),
                   poseFromYpr(0, 0, 0, 0.1 * static_cast<double>(i), 0, 0));
  }
  EXPECT_EQ(5U, keyframesOf(plainOptions(), turn));  // 0, 0.2, ... 0.8 rad
}

TEST(MapBuilder, HindsightChoosesTheSameKeyframes)
{
  const Trajectory drive = test::straightDrive(11, 0.4);
  MapBuilderOptions options = plainOptions();
  options.hindsight.hindsight = true;
  options.hindsight.window = 3;
  EXPECT_EQ(4U, keyframesOf(options, drive));
}

TEST(MapBuilder, TheMapHasThePlaceAndScansWithoutAPoseAreSkipped)
{
  const Trajectory drive = test::straightDrive(6, 1);
  Trajectory part;
  for (std::size_t i = 0; i < 4; ++i)
  {
    part.push_back(drive[i].stamp, drive[i].pose);
  }
  MapBuilder builder(plainOptions());
  builder.beginRun(part, test::asRecorded());
  addDrive(builder, drive);
  builder.finish();
  EXPECT_EQ(2U, builder.skipped());
  EXPECT_EQ(4U, builder.keyframes());
  EXPECT_EQ(nullptr, builder.scans());
  EXPECT_EQ(nullptr, builder.uncleanedMap());
  const MapPoints points = builder.map().points();
  ASSERT_GT(points.size(), 1000U);
  for (const auto& p : points.points)
  {
    EXPECT_TRUE(std::abs(p.z() - 0.05) < 0.1 || std::abs(std::abs(p.y()) - 6.05) < 0.1)
        << p.transpose();
  }
  EXPECT_GT(std::count_if(points.points.begin(), points.points.end(),
                          [](const auto& p) { return p.y() > 6; }),
            100);
}

TEST(MapBuilder, ScansThatTheRunCouldNotRegisterAreLeftOut)
{
  const TestFolder folder;
  const Trajectory drive = test::straightDrive(6, 2);
  RunScansOptions run = test::asRecorded();
  run.scan_table = folder.write("scans.csv", "frame,registered\n0,1\n1,1\n2,0\n3,0\n4,1\n5,1\n");
  MapBuilder builder(plainOptions());
  builder.beginRun(drive, run);
  addDrive(builder, drive);
  builder.finish();
  EXPECT_EQ(0U, builder.skipped());
  EXPECT_EQ(2U, builder.unregistered());
  EXPECT_EQ(4U, builder.keyframes());
}

TEST(MapBuilder, FarFromZeroTheMapIsRelativeToWholeKilometres)
{
  Trajectory far;
  Trajectory near;
  for (const auto& [stamp, pose] : test::straightDrive(3, 1))
  {
    near.push_back(stamp, pose);
    far.push_back(stamp, Eigen::Translation3d(456789, 5400100, 12) * pose);
  }
  MapBuilder builder(plainOptions());
  builder.beginRun(far, test::asRecorded());
  addDrive(builder, near);
  builder.finish();
  EXPECT_EQ(Eigen::Vector3d(456000, 5400000, 0), builder.origin());
  EXPECT_TRUE(builder.runs().front().trajectory()[0].pose.translation().isApprox(
      Eigen::Vector3d(789, 100, 12), 1e-9));
  for (const auto& p : builder.map().points().points)
  {
    EXPECT_NEAR(789, p.x(), 30);
  }
  MapBuilder at_zero(plainOptions());
  at_zero.beginRun(near, test::asRecorded());
  EXPECT_TRUE(at_zero.origin().isZero(0));
}

TEST(MapBuilder, WhatMovesByTheLabelsIsLeftOut)
{
  const TestFolder folder;
  const Eigen::Vector3d mover(4, 1, 1.05);
  const Frame frame = test::frameFrom(Pose::Identity(), 0, {mover});
  std::vector<Label> labels(frame.scan.size(), label_static);
  labels.back() = label_moving;
  writeLabels(folder.file("000000.label"), labels);
  MapBuilderOptions options = plainOptions();
  options.hindsight.hindsight = true;  // not needed where there are labels
  MapProducts products;
  products.labelled_map = true;
  products.uncleaned_map = true;
  products.scan_store = folder.file("scans");
  MapBuilder builder(options, products);
  RunScansOptions scans = test::asRecorded();
  scans.labels = folder.path();
  builder.beginRun(test::straightDrive(1, 1), scans);
  builder.add(frame);
  builder.finish();
  const auto hasMover = [&](const std::vector<Eigen::Vector3f>& points)
  {
    return std::any_of(points.begin(), points.end(),
                       [&](const auto& p)
                       { return (p.template cast<double>() - mover).norm() < 0.01; });
  };
  EXPECT_FALSE(hasMover(builder.map().points().points));
  ASSERT_NE(nullptr, builder.uncleanedMap());
  EXPECT_TRUE(hasMover(builder.uncleanedMap()->points().points));
  EXPECT_TRUE(hasMover(builder.labelledMap().points()));
  EXPECT_EQ(1, std::count(builder.labelledMap().labels().begin(),
                          builder.labelledMap().labels().end(), label_moving));
  ASSERT_NE(nullptr, builder.scans());
  EXPECT_EQ(1U, builder.scans()->size());
}

TEST(MapBuilder, SeveralRecordingsAreOneMap)
{
  const TestFolder folder;
  MapProducts products;
  products.scan_store = folder.file("scans");
  MapBuilder builder(plainOptions(), products);
  for (const double start : {0.0, 50.0})
  {
    const Trajectory drive = test::straightDrive(3, 1, start);
    builder.beginRun(drive, test::asRecorded());
    addDrive(builder, drive);
  }
  builder.finish();
  EXPECT_EQ(6U, builder.keyframes());
  ASSERT_EQ(2U, builder.runs().size());
  EXPECT_EQ(50, builder.runs().back().trajectory()[0].pose.translation().x());
  ASSERT_EQ(6U, builder.scans()->size());
  EXPECT_EQ(0U, builder.scans()->run(2));
  EXPECT_EQ(1U, builder.scans()->run(3));
  const MapPoints points = builder.map().points();
  EXPECT_TRUE(std::any_of(points.points.begin(), points.points.end(),
                          [](const auto& p) { return p.x() > 55; }));
}

TEST(MapBuilder, WithoutAWholeMapOnlyTheScansAreKept)
{
  const TestFolder folder;
  MapProducts products;
  products.whole_map = false;
  products.scan_store = folder.file("scans");
  MapBuilder builder(plainOptions(), products);
  const Trajectory drive = test::straightDrive(3, 1);
  builder.beginRun(drive, test::asRecorded());
  addDrive(builder, drive);
  builder.finish();
  EXPECT_EQ(0U, builder.map().pointCount());
  EXPECT_EQ(3U, builder.scans()->size());
}

TEST(MapBuilder, ScansThatCannotBeStoredAreAnError)
{
  MapProducts products;
  products.scan_store = "/no/such/folder/scans";
  EXPECT_THROW(MapBuilder(plainOptions(), products), UserError);
}
}  // namespace
}  // namespace dyslam
