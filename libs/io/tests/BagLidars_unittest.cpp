// SPDX-License-Identifier: BSD-3-Clause
// Further lidars of a bag, converted and merged.
#include <dyslam/base/Error.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/ScanConverter.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SyntheticCapture.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
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

TEST(BagLidars, ABagsLidarsArePlacedByItsTransforms)
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
    options.every_n = 1;
    options.only_first_n = 2;
    EXPECT_EQ(convertScans(input, rawlog, options).points, 160U) << "with the parts of the last";
  }
}

/** A lidar whose stamps are of another clock than those of the first one. */
TEST(BagLidars, ClocksAreComparedByTheTimesOfRecording)
{
  const TestFolder folder;
  const std::string input = folder.file("x.mcap");
  const auto linesAt = [&](double offset, double slower)
  {
    std::vector<test::TestMessage> messages{
        {"/tf_static", "tf2_msgs/TFMessage", bag_begin,
         test::transforms(true, bag_begin,
                          {{"front_lidar", Pose::Identity()},
                           {"rear_lidar", poseFromYpr(-2, 0, 1, M_PI, 0, 0)}})}};
    for (std::size_t i = 0; i < 12; ++i)
    {
      const double stamp = bag_begin + 0.125 * static_cast<double>(i);
      const double recorded = stamp + 0.1 + slower * static_cast<double>(i);
      messages.push_back({"/front/points", "sensor_msgs/PointCloud2", recorded,
                          bagScan(true, stamp, i, "front_lidar")});
      messages.push_back({"/rear/points", "sensor_msgs/PointCloud2", recorded + 0.05,
                          bagScan(true, stamp + offset, i, "rear_lidar")});
    }
    test::writeBag(input, messages);
    ScanConverterOptions options;
    options.topic = "";
    options.further_topics = {"/rear/points"};
    return convertScans(input, folder.file("x.rawlog"), options);
  };
  const std::string later =
      "/rear/points: its stamps are about 0.95 s later than those of /front/points";
  EXPECT_TRUE(hasLine(linesAt(1, 0).warnings, later));
  EXPECT_TRUE(hasLine(linesAt(-37, 0).warnings, "s earlier than those of /front/points"));
  EXPECT_FALSE(hasLine(linesAt(1, 0.1).warnings, later)) << "not recorded as it came";
  const ConversionResult same = linesAt(0, 0);
  EXPECT_TRUE(same.warnings.empty()) << same.warnings.front();
  EXPECT_TRUE(hasLine(same.notes, "/rear/points: per-point time: field time"));
}

struct BagScan
{
  std::string topic;
  double stamp = 0;  //!< after the begin [s]
  double delay = 0;  //!< until it is recorded [s]
};

/** A bag of lidars at the front and the rear of a vehicle, in order of their recording. */
void writeBagOfScans(const std::string& path,
                     std::vector<BagScan> scans,
                     const std::function<Scan(const BagScan&)>& scanOf = nullptr,
                     std::size_t imu_samples = 0)
{
  const bool cdr = test::holdsCdr(path);
  std::vector<test::TestMessage> messages{
      {"/tf_static", "tf2_msgs/TFMessage", bag_begin - 10,
       test::transforms(cdr, bag_begin,
                        {{"front_lidar", poseFromYpr(1, 0, 1.5, 0, 0, 0)},
                         {"rear_lidar", poseFromYpr(-2, 0, 1, M_PI, 0, 0)}})}};
  for (const BagScan& scan : scans)
  {
    const std::string frame = contains(scan.topic, "front") ? "front_lidar" : "rear_lidar";
    const double stamp = bag_begin + scan.stamp;
    messages.push_back(
        {scan.topic, "sensor_msgs/PointCloud2", stamp + scan.delay,
         scanOf ? test::pointCloud2(cdr, stamp, test::velodyneFields(scanOf(scan)), 1, frame)
                : bagScan(cdr, stamp, 0, frame)});
  }
  for (std::size_t i = 0; i < imu_samples; ++i)  // recorded late
  {
    const double stamp = bag_begin + 0.0078125 * static_cast<double>(i);
    test::ImuValues values;
    values.acceleration = {0, 0, 9.81};
    messages.push_back({"/imu", "sensor_msgs/Imu", stamp + 0.9, test::imu(cdr, stamp, values)});
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  test::writeBag(path, messages);
}

ScanConverterOptions frontAndRear()
{
  ScanConverterOptions options;
  options.topic = "/front/points";
  options.further_topics = {"/rear/points"};
  return options;
}

std::vector<Frame> convertedFrames(const TestFolder& folder, const ScanConverterOptions& options)
{
  (void)convertScans(folder.file("x.mcap"), folder.file("x.rawlog"), options);
  RawlogSourceOptions both;
  both.further_lidars = options.furtherLidars();
  RawlogSource source(folder.file("x.rawlog"), both);
  return framesOf(source);
}

TEST(BagLidars, ConvertedScansHaveThoseNearestToThem)
{
  const TestFolder folder;
  std::vector<BagScan> scans{{"/rear/points", -0.03125, 0}};
  for (int i = 0; i < 4; ++i)
  {
    scans.push_back({"/front/points", 0.125 * i, 0});
    scans.push_back({"/rear/points", 0.125 * i + 0.03125, 0});
    scans.push_back({"/rear/points", 0.125 * i + 0.09375, 0});
  }
  writeBagOfScans(folder.file("x.mcap"), scans);
  ScanConverterOptions options = frontAndRear();
  const PartStamps both{{-0.031, 0.031}, {-0.031, 0.031}, {-0.031, 0.031}, {-0.031, 0.031, 0.094}};
  EXPECT_EQ(partStamps(convertedFrames(folder, options)), both);
  options.every_n = 2;
  EXPECT_EQ(partStamps(convertedFrames(folder, options)), (PartStamps{both[0], both[2]}));
  options.every_n = 1;
  options.only_first_n = 2;
  EXPECT_EQ(partStamps(convertedFrames(folder, options)), (PartStamps{both[0], both[1]}));
}

TEST(BagLidars, ImuSamplesPrecedeTheScansOfAll)
{
  const TestFolder folder;
  std::vector<BagScan> scans;
  for (int i = 0; i < 8; ++i)
  {
    scans.push_back({"/front/points", 0.125 * i, 0});
    for (int k = 0; k < 2; ++k)
    {
      scans.push_back({"/rear/points", 0.125 * i + 0.0625 * k, 0.03});
    }
  }
  writeBagOfScans(folder.file("x.mcap"), scans, nullptr, 128);
  ScanConverterOptions options = frontAndRear();
  options.imu_topic = "/imu";
  const std::vector<Frame> frames = convertedFrames(folder, options);
  ASSERT_EQ(frames.size(), 8U);
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    EXPECT_EQ(frames[i].scan.parts.size(), i == 0 ? 1U : i + 1 < frames.size() ? 2U : 3U) << i;
    ASSERT_FALSE(frames[i].imu.empty()) << i;
    EXPECT_NEAR(frames[i].imu.back().stamp, frames[i].scan.stamp, 1e-6);
  }
}

TEST(BagLidars, AScanOfOneReturnKeepsItsTime)
{
  const TestFolder folder;
  const auto scanOf = [](const BagScan& of)
  {
    const bool is_single = of.topic == "/rear/points" && of.stamp > 0.1;
    Scan scan = someScan(0, is_single ? 1 : 40);
    for (std::size_t k = 0; k < scan.size(); ++k)
    {
      scan.time.push_back(0.01F + 1e-3F * static_cast<float>(k));
      scan.ring.push_back(1);
    }
    return scan;
  };
  writeBagOfScans(folder.file("x.mcap"),
                  {{"/front/points", 0, 0},
                   {"/rear/points", 0.03125, 0},
                   {"/front/points", 0.125, 0},
                   {"/rear/points", 0.15625, 0}},
                  scanOf);
  const std::vector<Frame> frames = convertedFrames(folder, frontAndRear());
  ASSERT_EQ(frames.size(), 2U);
  ASSERT_EQ(frames[1].scan.time.size(), 41U);
  EXPECT_NEAR(frames[1].scan.time[40], 0.04125F, 1e-4F);
}

TEST(BagLidars, TheLabelsOfTopicsDiffer)
{
  RecordingOptions options;
  options.further_topics = {"/lidar", "/a/b", "/a_b", "/a.c"};
  EXPECT_EQ(options.furtherLabels(), (std::vector<std::string>{"lidar_2", "a_b", "a_b_2", "a.c"}));
  EXPECT_EQ(options.furtherLidars(), "lidar_2|a_b|a_b_2|a\\.c");
  options.sensor = "a_b";
  EXPECT_EQ(options.furtherLabels(), (std::vector<std::string>{"lidar", "a_b_2", "a_b_3", "a.c"}));
  options.further_topics.assign(4, "/" + std::string(70, 'x'));
  const auto message = messageOfError<UserError>([&] { (void)options.furtherLidars(); });
  EXPECT_TRUE(contains(message, "--further-topic")) << message;
  options.further_topics = {"/a/b=c/d.csv", "/e"};
  options.calibration = "f.yaml";
  EXPECT_EQ(options.furtherLabels(), (std::vector<std::string>{"a_b_2", "e"}));
  EXPECT_EQ(options.files(), (std::vector<std::string>{"f.yaml", "c/d.csv"}));
  const std::string here = std::filesystem::current_path().string();
  const RecordingOptions absolute = options.withAbsolutePaths();
  EXPECT_EQ(absolute.files(), (std::vector<std::string>{here + "/f.yaml", here + "/c/d.csv"}));
  EXPECT_EQ(absolute.further_topics[1], "/e");
  EXPECT_TRUE(
      contains(messageOfError<UserError>([] { (void)splitFurtherTopic("/a="); }), "names no file"));

  const TestFolder folder;
  writeBagOfScans(folder.file("x.mcap"), {{"/front/points", 0, 0}, {"/lidar", 0.03125, 0}});
  ScanConverterOptions lidar = frontAndRear();
  lidar.further_topics = {"/lidar"};
  EXPECT_EQ(partStamps(convertedFrames(folder, lidar)), (PartStamps{{0.031}}));
}

TEST(BagLidars, SensorAndCalibrationAreThoseOfTheFirst)
{
  const TestFolder folder;
  constexpr double packet_time = 12 * 2 * 55.296e-6;  // [s]
  const bool cdr = false;
  std::vector<test::TestMessage> messages{
      {"/tf_static", "tf2_msgs/TFMessage", bag_begin,
       test::transforms(cdr, bag_begin,
                        {{"front_lidar", poseFromYpr(1, 0, 1.5, 0, 0, 0)},
                         {"velodyne", poseFromYpr(-2, 0, 1, M_PI, 0, 0)}})}};
  for (std::size_t n = 0; n < 400; ++n)
  {
    const double time = static_cast<double>(n) * packet_time;
    if (n % 76 == 0)
    {
      messages.push_back({"/front/points", "sensor_msgs/PointCloud2", bag_begin + time,
                          bagScan(cdr, bag_begin + time, n / 76, "front_lidar")});
    }
    messages.push_back(
        {"/velodyne_packets", "velodyne_msgs/VelodyneScan", bag_begin + time,
         test::velodyneScan(cdr, bag_begin + time, {{bag_begin + time, velodynePacket(time)}})});
  }
  test::writeBag(folder.file("x.bag"), messages);
  ScanConverterOptions options;
  options.topic = "/front/points";
  options.further_topics = {"/velodyne_packets"};
  options.sensor = "roof";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_EQ(6U, result.scans);
  EXPECT_GT(result.points, 3 * 27000U) << "with three revolutions of the further lidar";
  std::string yaml = "lasers:\n";
  for (int i = 0; i < 16; ++i)
  {
    yaml += "- {dist_correction: 0.5, laser_id: " + std::to_string(i) +
            ", rot_correction: 0.1, vert_correction: " + std::to_string(0.02 * i) + "}\n";
  }
  const std::string calibration = folder.write("a.yaml", yaml + "num_lasers: 16\n");
  options.further_topics = {"/velodyne_packets=" + calibration};
  (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  RawlogSourceOptions of_further;
  of_further.sensor_label = options.furtherLidars();
  EXPECT_EQ(of_further.sensor_label, "velodyne_packets");
  RawlogSource source(folder.file("x.rawlog"), of_further);
  const auto frame = source.next();
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->scan.points.at(0).norm(), 10.5, 1e-3) << "the spheres' radius is 10 m";
  options.topic = "/velodyne_packets";
  options.sensor = "";
  options.further_topics = {"/front/points=" + calibration};
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options); }),
      "--further-topic /front/points=FILE works with packets only"));
  options.further_topics = {"/front/points"};
  options.keep_partial = true;
  EXPECT_EQ(6U, convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options).scans);
}

TEST(BagLidars, ALidarOfABagThatCannotBePlacedIsAnError)
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
