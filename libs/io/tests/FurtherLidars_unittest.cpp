// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
const Pose T_vehicle_rear = poseFromYpr(-2, 0, 1, M_PI, 0, 0);

Scan frontScan(std::size_t number)
{
  Scan scan = someScan(number, 20);
  scan.sensor_label = "front";
  scan.time.assign(scan.size(), 0.01F);
  scan.ring.assign(scan.size(), 3);
  return scan;
}

/** \param stamp after that of the first front scan [s] */
Scan rearScan(double stamp, std::size_t points = 7)
{
  Scan scan = someScan(0, points);
  scan.stamp = 100 + stamp;
  scan.sensor_label = "rear";
  scan.T_vehicle_lidar = T_vehicle_rear;
  scan.time.assign(scan.size(), 0.02F);
  scan.ring.assign(scan.size(), 4);
  return scan;
}

/** Writes the scans in order of time, those of the front every 0.1 s. */
void writeScans(const std::string& path, std::size_t front, std::vector<Scan> rear)
{
  std::vector<Scan> all = std::move(rear);
  for (std::size_t i = 0; i < front; ++i)
  {
    all.push_back(frontScan(i));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Scan& a, const Scan& b) { return a.stamp < b.stamp; });
  RawlogWriter writer(path);
  for (const Scan& scan : all)
  {
    writer.write(scan);
  }
  writer.close();
}

RawlogSourceOptions bothLidars()
{
  RawlogSourceOptions options;
  options.sensor_label = "front";
  options.further_lidars = "re.*";
  return options;
}

TEST(FurtherLidars, ScansJoinTheNearestOneOfTheFirst)
{
  const TestFolder folder;
  // The second front scan gets two, the third none.
  writeScans(folder.file("a.rawlog"), 4,
             {rearScan(-0.02), rearScan(0.07), rearScan(0.13), rearScan(0.32)});
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  const std::vector<Frame> frames = framesOf(source);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(source.sensorLabel(), "front");
  const std::vector<std::vector<double>> expected{{-0.02}, {-0.03, 0.03}, {}, {0.02}};
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    const Scan& scan = frames[i].scan;
    ASSERT_EQ(scan.parts.size(), expected[i].size()) << i;
    EXPECT_EQ(scan.size(), 20 + 7 * expected[i].size());
    for (std::size_t k = 0; k < scan.parts.size(); ++k)
    {
      EXPECT_NEAR(scan.parts[k].stamp, expected[i][k], 1e-6);
      EXPECT_EQ(scan.parts[k].lidar, 1U);
      EXPECT_EQ(scan.parts[k].begin, 20 + 7 * k);
    }
  }
  const Scan& first = frames[0].scan;
  EXPECT_TRUE((first.T_vehicle_lidar * first.points[22].cast<double>())
                  .isApprox(T_vehicle_rear * rearScan(0).points[2].cast<double>(), 1e-5));
  EXPECT_NEAR(first.time[22], 0.0F, 1e-5F) << "0.02 s after a stamp 0.02 s earlier";
  EXPECT_EQ(first.ring.size(), first.size());
  EXPECT_TRUE(source.warnings().empty()) << source.warnings().front();
}

TEST(FurtherLidars, TheVehicleIsLevelledAsAWhole)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 1, {rearScan(0)});
  RawlogSourceOptions options = bothLidars();
  RawlogSource recorded(folder.file("a.rawlog"), options);
  options.roll = 0.1;
  options.pitch = -0.3;
  RawlogSource levelled(folder.file("a.rawlog"), options);
  const Scan before = recorded.next()->scan;
  const Scan after = levelled.next()->scan;
  EXPECT_FALSE(after.T_vehicle_lidar.isApprox(before.T_vehicle_lidar, 1e-3));
  EXPECT_TRUE(after.parts[0].T_scan_lidar.isApprox(before.parts[0].T_scan_lidar, 1e-12));
  EXPECT_TRUE(samePoints(before, after));
}

TEST(FurtherLidars, ScansFarFromAllOfTheFirstAreLeftOut)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 2, {rearScan(-0.4), rearScan(0.01), rearScan(0.5)});
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  const std::vector<Frame> frames = framesOf(source);
  EXPECT_EQ(frames[0].scan.parts.size(), 1U);
  EXPECT_EQ(frames[1].scan.parts.size(), 0U);
  ASSERT_EQ(source.warnings().size(), 1U);
  EXPECT_TRUE(contains(source.warnings()[0], "2 scans of further lidars")) << source.warnings()[0];
}

TEST(FurtherLidars, SkippedScansTakeTheirPartsWithThem)
{
  const TestFolder folder;
  std::vector<Scan> rear;
  for (int i = 0; i < 8; ++i)
  {
    rear.push_back(rearScan(0.1 * i + 0.01));
  }
  writeScans(folder.file("a.rawlog"), 8, rear);
  RawlogSourceOptions options = bothLidars();
  options.skip_first_n = 5;
  RawlogSource source(folder.file("a.rawlog"), options);
  const std::vector<Frame> frames = framesOf(source);
  ASSERT_EQ(frames.size(), 3U);
  for (const Frame& frame : frames)
  {
    ASSERT_EQ(frame.scan.parts.size(), 1U) << frame.index;
    EXPECT_NEAR(frame.scan.parts[0].stamp, 0.01, 1e-6);
  }
}

/** Writes the scans in the given order. */
void writeInOrder(const std::string& path, const std::vector<Scan>& scans)
{
  RawlogWriter writer(path);
  for (const Scan& scan : scans)
  {
    writer.write(scan);
  }
  writer.close();
}

Scan labelled(Scan scan, const std::string& label)
{
  scan.sensor_label = label;
  return scan;
}

TEST(FurtherLidars, TwoOfThemAreKeptApart)
{
  const TestFolder folder;
  Scan left = labelled(rearScan(0.01, 5), "left");
  left.T_vehicle_lidar = poseFromYpr(1, 1, 1, M_PI / 2, 0, 0);
  Scan right = labelled(rearScan(0.02, 6), "right");
  right.T_vehicle_lidar = poseFromYpr(1, -1, 1, -M_PI / 2, 0, 0);
  Scan left_again = left;
  left_again.stamp += 0.1;
  Scan right_again = right;
  right_again.stamp += 0.1;
  writeInOrder(folder.file("a.rawlog"),
               {frontScan(0), left, right, frontScan(1), right_again, left_again});
  RawlogSourceOptions options = bothLidars();
  options.further_lidars = "left|right";
  RawlogSource source(folder.file("a.rawlog"), options);
  const std::vector<Frame> frames = framesOf(source);
  ASSERT_EQ(frames.size(), 2U);
  for (const Frame& frame : frames)
  {
    const std::vector<ScanPart>& parts = frame.scan.parts;
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].sensor_label, "left");
    EXPECT_EQ(parts[0].lidar, 1U);
    EXPECT_EQ(parts[0].begin, 20U);
    EXPECT_EQ(parts[1].sensor_label, "right");
    EXPECT_EQ(parts[1].lidar, 2U);
    EXPECT_EQ(parts[1].begin, 25U);
    EXPECT_EQ(frame.scan.size(), 31U);
    EXPECT_EQ(std::set<std::uint16_t>(frame.scan.ring.begin(), frame.scan.ring.end()).size(), 3U);
  }
  EXPECT_TRUE(source.warnings().empty()) << source.warnings().front();
}

TEST(FurtherLidars, ScansRecordedLateJoinTheirs)
{
  const TestFolder folder;
  writeInOrder(folder.file("a.rawlog"),
               {frontScan(0), frontScan(1), rearScan(0.01), frontScan(2), frontScan(3),
                rearScan(0.11), rearScan(0.21), rearScan(0.31)});
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  EXPECT_EQ(partStamps(framesOf(source)), (PartStamps{{0.01}, {0.01}, {0.01}, {0.01}}));
  RawlogSourceOptions first_two = bothLidars();
  first_two.end = 0.15;
  RawlogSource part(folder.file("a.rawlog"), first_two);
  EXPECT_EQ(partStamps(framesOf(part)), (PartStamps{{0.01}, {0.01}}));
}

TEST(FurtherLidars, ADroppedScanOfTheFirstTakesNoPartsAway)
{
  const TestFolder folder;
  Scan same = frontScan(1);
  same.stamp = frontScan(0).stamp;
  writeInOrder(folder.file("a.rawlog"), {rearScan(-0.01), frontScan(0), rearScan(0.02), same,
                                         rearScan(0.03), frontScan(1), rearScan(0.11)});
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  EXPECT_EQ(partStamps(framesOf(source)), (PartStamps{{-0.01, 0.02, 0.03}, {0.01}}));
  EXPECT_EQ(source.framesDropped(), 1U);
}

TEST(FurtherLidars, PartsOfTheFirstScanPastTheEndAreLeftOut)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 4, {rearScan(0.11), rearScan(0.17), rearScan(0.21)});
  RawlogSourceOptions options = bothLidars();
  options.end = 0.2;
  RawlogSource source(folder.file("a.rawlog"), options);
  EXPECT_EQ(partStamps(framesOf(source)), (PartStamps{{}, {0.01}}));
}

TEST(FurtherLidars, TheyAreNotTheFirstOne)
{
  const TestFolder folder;
  const Scan left = labelled(rearScan(-0.01), "lidar_left");
  writeInOrder(folder.file("a.rawlog"),
               {left, labelled(frontScan(0), "lidar_roof"), labelled(frontScan(1), "lidar_roof")});
  RawlogSourceOptions options;
  options.further_lidars = "lidar_(left|right)";
  RawlogSource source(folder.file("a.rawlog"), options);
  EXPECT_EQ(source.sensorLabel(), "lidar_roof");
  EXPECT_EQ(partStamps(framesOf(source)), (PartStamps{{-0.01}, {}}));

  options.merge_further = false;
  RawlogSource alone(folder.file("a.rawlog"), options);
  EXPECT_EQ(alone.sensorLabel(), "lidar_roof");
  EXPECT_EQ(partStamps(framesOf(alone)), (PartStamps{{}, {}}));
  EXPECT_TRUE(alone.warnings().empty()) << alone.warnings().front();

  options.merge_further = true;
  options.further_lidars = "lidar_.*";
  const auto message =
      messageOfError<UserError>([&] { RawlogSource(folder.file("a.rawlog"), options); });
  EXPECT_TRUE(contains(message, "'lidar_left', 'lidar_roof'")) << message;
  EXPECT_TRUE(contains(message, "sensor_label")) << message;
  options.sensor_label = "lidar_roof";
  EXPECT_EQ(partStamps({*RawlogSource(folder.file("a.rawlog"), options).next()}),
            (PartStamps{{-0.01}}));
}

TEST(FurtherLidars, WithoutTheFirstOnlyAFewAreHeld)
{
  const TestFolder folder;
  std::vector<Scan> scans;
  for (int i = 0; i < 60; ++i)
  {
    scans.push_back(rearScan(0.1 * i - 5.99));
  }
  scans.push_back(frontScan(0));
  writeInOrder(folder.file("a.rawlog"), scans);
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  ASSERT_EQ(source.warnings().size(), 2U) << "those too old were dropped before the first scan";
  EXPECT_TRUE(contains(source.warnings()[1], " scans of further lidars")) << source.warnings()[1];
  EXPECT_EQ(framesOf(source)[0].scan.parts.size(), 1U);
  ASSERT_EQ(source.warnings().size(), 1U);
  EXPECT_TRUE(contains(source.warnings()[0], "59 scans of further lidars"));
}

TEST(FurtherLidars, ManyScansOfOneTimeAreNotHeld)
{
  const TestFolder folder;
  std::vector<Scan> scans(150, rearScan(0));
  scans.push_back(frontScan(0));
  writeInOrder(folder.file("a.rawlog"), scans);
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  EXPECT_EQ(framesOf(source)[0].scan.parts.size(), 100U);
}

TEST(FurtherLidars, MoreLidarsThanAVehicleHasAreAnError)
{
  const TestFolder folder;
  const auto read = [&](int further)
  {
    std::vector<Scan> scans;
    for (int i = 0; i < further; ++i)
    {
      scans.push_back(labelled(rearScan(0), "re" + std::to_string(i)));
    }
    scans.push_back(frontScan(0));
    writeInOrder(folder.file("a.rawlog"), scans);
    return RawlogSource(folder.file("a.rawlog"), bothLidars()).next()->scan.parts.size();
  };
  EXPECT_EQ(read(15), 15U);
  const auto message = messageOfError<UserError>([&] { (void)read(16); });
  EXPECT_TRUE(contains(message, "a.rawlog: further_lidars = re.*")) << message;
  EXPECT_TRUE(contains(message, "more than 15 lidars")) << message;
}

TEST(FurtherLidars, ADamagedScanIsNamed)
{
  const TestFolder folder;
  RawlogWriterOptions external;
  external.external_storage = true;
  {
    RawlogWriter writer(folder.file("a.rawlog"), external);
    writer.write(frontScan(0));
    writer.write(rearScan(0.01));
    writer.close();
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
  {
    if (contains(entry.path().filename().string(), "rear"))
    {
      std::filesystem::resize_file(entry.path(), 10);
    }
  }
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  const auto message = messageOfError<UserError>([&] { (void)source.next(); });
  EXPECT_TRUE(contains(message, "a.rawlog: scan 0: that of 'rear'")) << message;
}

TEST(FurtherLidars, EmptyScansAreNoParts)
{
  const TestFolder folder;
  writeInOrder(folder.file("a.rawlog"), {frontScan(0), rearScan(0.01, 0), rearScan(0.02)});
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  const Scan scan = source.next()->scan;
  EXPECT_EQ(scan.parts.size(), 1U);
  EXPECT_EQ(scan.time.size(), 27U);
  ASSERT_EQ(source.warnings().size(), 1U);
  EXPECT_TRUE(contains(source.warnings()[0], "an empty scan of 'rear'")) << source.warnings()[0];
}

TEST(FurtherLidars, OneWithoutTimesLeavesThoseOfTheOthers)
{
  const TestFolder folder;
  Scan bare = labelled(rearScan(0.01), "re_bare");
  bare.T_vehicle_lidar = poseFromYpr(0, 2, 1, 0, 0, 0);
  bare.time.clear();
  writeInOrder(folder.file("a.rawlog"), {frontScan(0), bare, rearScan(0.03)});
  RawlogSource source(folder.file("a.rawlog"), bothLidars());
  const Scan scan = source.next()->scan;
  ASSERT_EQ(scan.time.size(), 34U);
  EXPECT_NEAR(scan.time[0], 0.01F, 1e-6F);
  EXPECT_NEAR(scan.time[22], 0.01F, 1e-6F) << "the stamp of its scan";
  EXPECT_NEAR(scan.time[30], 0.05F, 1e-6F);
  ASSERT_EQ(source.warnings().size(), 1U);
  EXPECT_TRUE(contains(source.warnings()[0], "'re_bare' have no times")) << source.warnings()[0];
}

TEST(FurtherLidars, TheUserLearnsWhatDoesNotFit)
{
  const TestFolder folder;
  Scan at_front = labelled(rearScan(0.01), "re_front");
  at_front.T_vehicle_lidar = frontScan(0).T_vehicle_lidar;
  Scan bare = frontScan(0);
  bare.time.clear();
  writeInOrder(folder.file("a.rawlog"),
               {bare, at_front, rearScan(0), labelled(rearScan(0.02), "re_other")});
  RawlogSource same(folder.file("a.rawlog"), bothLidars());
  EXPECT_TRUE(same.next()->scan.time.empty());
  const std::vector<std::string> notes = same.warnings();
  ASSERT_EQ(notes.size(), 5U);
  EXPECT_TRUE(contains(notes[0], "'re_front' has the same sensorPose as 'front'")) << notes[0];
  EXPECT_TRUE(contains(notes[1], "'re_front' are not used")) << notes[1];
  EXPECT_TRUE(contains(notes[2], "'rear' are not used")) << notes[2];
  EXPECT_TRUE(contains(notes[3], "'re_other' has the same sensorPose as 'rear'")) << notes[3];

  RawlogSourceOptions options = bothLidars();
  options.further_lidars = "roof";
  RawlogSource none(folder.file("a.rawlog"), options);
  EXPECT_TRUE(none.next()->scan.parts.empty());
  ASSERT_EQ(none.warnings().size(), 1U);
  EXPECT_TRUE(contains(none.warnings()[0], "no further lidar has a label like 'roof'"));

  options.further_lidars = "(";
  const auto message =
      messageOfError<UserError>([&] { RawlogSource(folder.file("a.rawlog"), options); });
  EXPECT_TRUE(contains(message, "further_lidars")) << message;
}
}  // namespace
}  // namespace dyslam
