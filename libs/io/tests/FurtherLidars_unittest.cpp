// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/io/Converters.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>

#include <algorithm>
#include <string>
#include <vector>

#include "BagWriters.h"
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

std::vector<Frame> framesOf(RawlogSource& source)
{
  std::vector<Frame> frames;
  while (auto frame = source.next())
  {
    frames.push_back(std::move(*frame));
  }
  return frames;
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

TEST(FurtherLidars, TheUserLearnsWhatDoesNotFit)
{
  const TestFolder folder;
  Scan at_front = rearScan(0);
  at_front.T_vehicle_lidar = frontScan(0).T_vehicle_lidar;
  at_front.time.clear();
  at_front.ring.clear();
  writeScans(folder.file("a.rawlog"), 1, {at_front});
  RawlogSource same(folder.file("a.rawlog"), bothLidars());
  EXPECT_TRUE(same.next()->scan.time.empty());
  ASSERT_EQ(same.warnings().size(), 2U);
  EXPECT_TRUE(contains(same.warnings()[0], "same sensorPose")) << same.warnings()[0];
  EXPECT_TRUE(contains(same.warnings()[1], "only one has the times")) << same.warnings()[1];

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

constexpr double bag_begin = 1600000000;  // [s]

std::string bagScan(bool cdr, double stamp, std::size_t number, const std::string& frame)
{
  Scan scan = someScan(number, 40);
  for (std::size_t k = 0; k < scan.size(); ++k)
  {
    scan.time.push_back(1e-3F * static_cast<float>(k));
    scan.ring.push_back(static_cast<std::uint16_t>(k % 16));
  }
  return test::pointCloud2(cdr, stamp, test::velodyneFields(scan), 1, frame);
}

/** Four scans each of a lidar at the front and one at the rear, 0.03125 s later. */
void writeBagOfTwo(const std::string& path, bool with_transforms)
{
  const bool cdr = test::holdsCdr(path);
  std::vector<test::TestMessage> messages;
  if (with_transforms)
  {
    messages.push_back({"/tf_static", "tf2_msgs/TFMessage", bag_begin,
                        test::transforms(cdr, bag_begin,
                                         {{"front_lidar", poseFromYpr(1, 0, 1.5, 0, 0, 0)},
                                          {"rear_lidar", poseFromYpr(-2, 0, 1, M_PI, 0, 0)}})});
  }
  for (std::size_t i = 0; i < 4; ++i)
  {
    const double stamp = bag_begin + 0.125 * static_cast<double>(i);
    messages.push_back({"/front/points", "sensor_msgs/PointCloud2", stamp + 0.001,
                        bagScan(cdr, stamp, i, "front_lidar")});
    messages.push_back({"/rear/points", "sensor_msgs/PointCloud2", stamp + 0.04,
                        bagScan(cdr, stamp + 0.03125, i, "rear_lidar")});
  }
  test::writeBag(path, messages);
}

TEST(FurtherLidars, ABagsLidarsArePlacedByItsTransforms)
{
  const TestFolder folder;
  for (const std::string ending : {".bag", ".mcap"})
  {
    const std::string input = folder.file("x" + ending);
    const std::string rawlog = folder.file("x.rawlog");
    writeBagOfTwo(input, true);
    ScanConverterOptions options;
    options.topic = "/front/points";
    options.further_topics = {"/rear/points"};
    options.base_frame = "map";
    const auto result = convertScans(input, rawlog, options);
    EXPECT_EQ(result.scans, 4U);
    EXPECT_EQ(result.points, 320U);
    RawlogSourceOptions both;
    both.further_lidars = "rear_points";
    RawlogSource source(rawlog, both);
    const std::vector<Frame> frames = framesOf(source);
    ASSERT_EQ(frames.size(), 4U);
    for (const Frame& frame : frames)
    {
      ASSERT_EQ(frame.scan.parts.size(), 1U);
      EXPECT_NEAR(frame.scan.parts[0].stamp, 0.03125, 1e-6);
      EXPECT_TRUE((frame.scan.T_vehicle_lidar * frame.scan.parts[0].T_scan_lidar)
                      .isApprox(poseFromYpr(-2, 0, 1, M_PI, 0, 0), 1e-6));
      EXPECT_EQ(frame.scan.time.size(), 80U);
    }
    options.every_n = 2;
    EXPECT_EQ(convertScans(input, rawlog, options).points, 160U);
  }
}

TEST(FurtherLidars, ALidarOfABagThatCannotBePlacedIsAnError)
{
  const TestFolder folder;
  const std::string input = folder.file("x.mcap");
  ScanConverterOptions options;
  options.topic = "/front/points";
  const auto error = [&](const std::vector<std::string>& topics)
  {
    options.further_topics = topics;
    return messageOfError<UserError>(
        [&] { (void)convertScans(input, folder.file("x.rawlog"), options); });
  };
  writeBagOfTwo(input, true);
  EXPECT_TRUE(contains(error({"/front/points"}), "is the topic of the first lidar"));
  EXPECT_TRUE(contains(error({"/rear/points", "/rear/points"}), "is given twice"));
  EXPECT_TRUE(contains(error({"/roof/points"}), "--further-topic"));
  writeBagOfTwo(input, false);
  EXPECT_TRUE(contains(error({"/rear/points"}),
                       "/tf_static does not connect its frame 'rear_lidar' to 'front_lidar'"));
}
}  // namespace
}  // namespace dyslam
