// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/io/ReplayWriter.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "FullDisk.h"
#include "MotionBytes.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

Frame someFrame(std::size_t points)
{
  Frame frame;
  frame.scan.stamp = 100;
  frame.cloud.points = someScan(0, points).points;
  return frame;
}
}  // namespace

class RawlogRoundTrip : public ::testing::TestWithParam<bool>
{
};

TEST_P(RawlogRoundTrip, KeepsEverything)
{
  const TestFolder folder;
  RawlogWriterOptions options;
  options.external_storage = GetParam();
  writeScans(folder.file("a.rawlog"), 5, options);
  EXPECT_EQ(GetParam(), std::filesystem::exists(folder.file("a_Images")));

  RawlogSource source(folder.file("a.rawlog"));
  for (std::size_t i = 0; i < 5; ++i)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    const Scan expected = someScan(i, 50 + i);
    EXPECT_EQ(i, frame->index);
    EXPECT_EQ(expected.stamp, frame->scan.stamp);
    EXPECT_EQ("velodyne", frame->scan.sensor_label);
    EXPECT_TRUE(samePoints(expected, frame->scan));
    EXPECT_EQ(expected.intensity, frame->scan.intensity);
    EXPECT_TRUE(frame->scan.time.empty());
    EXPECT_TRUE(frame->scan.ring.empty());
    EXPECT_TRUE(frame->scan.T_vehicle_lidar.isApprox(expected.T_vehicle_lidar, 1e-12));
    ASSERT_TRUE(frame->T_world_vehicle_truth);
    EXPECT_TRUE(frame->T_world_vehicle_truth->isApprox(somePose(i), 1e-12));
  }
  EXPECT_FALSE(source.next());
  EXPECT_FALSE(source.next());
  EXPECT_EQ(5U, source.framesRead());
  EXPECT_DOUBLE_EQ(1.0, source.progress());
  EXPECT_TRUE(source.warnings().empty());
}

TEST(RawlogSource, LevelsTheVehicleFrame)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    writer.write(test::imuSample(someScan(0, 5).stamp - 0.01));
    writer.write(someScan(0, 5), somePose(0));
    writer.close();
  }
  RawlogSource recorded(folder.file("a.rawlog"));
  RawlogSourceOptions options;
  options.roll = 0.1;
  options.pitch = -0.3;
  RawlogSource levelled(folder.file("a.rawlog"), options);
  const auto before = recorded.next();
  const auto after = levelled.next();
  ASSERT_TRUE(before && after);
  const Pose T = poseFromYpr(0, 0, 0, 0, -0.3, 0.1);
  EXPECT_TRUE(after->scan.T_vehicle_lidar.isApprox(T * before->scan.T_vehicle_lidar, 1e-12));
  ASSERT_EQ(1U, before->imu.size());
  ASSERT_EQ(1U, after->imu.size());
  EXPECT_TRUE(after->imu[0].T_vehicle_imu.isApprox(T * before->imu[0].T_vehicle_imu, 1e-12));
  // The lidar is where it was.
  ASSERT_TRUE(before->T_world_vehicle_truth && after->T_world_vehicle_truth);
  EXPECT_TRUE((*after->T_world_vehicle_truth * after->scan.T_vehicle_lidar)
                  .isApprox(*before->T_world_vehicle_truth * before->scan.T_vehicle_lidar, 1e-9));
  EXPECT_TRUE(samePoints(before->scan, after->scan));
}

TEST_P(RawlogRoundTrip, KeepsTimeAndRing)
{
  const TestFolder folder;
  RawlogWriterOptions options;
  options.external_storage = GetParam();
  // Neither, both, only time, only ring: in one file, so that nothing sticks.
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < 8; ++i)
  {
    scans.push_back(someScan(i, 20));
    for (std::size_t k = 0; k < 20; ++k)
    {
      if (i % 4 == 1 || i % 4 == 2)
      {
        scans.back().time.push_back(0.1F * static_cast<float>(k) - 0.7F);
      }
      if (i % 4 == 1 || i % 4 == 3)
      {
        scans.back().ring.push_back(static_cast<std::uint16_t>(k * 3000));
      }
    }
  }
  {
    RawlogWriter writer(folder.file("a.rawlog"), options);
    for (const Scan& scan : scans)
    {
      writer.write(scan);
    }
    writer.close();
  }
  RawlogSource source(folder.file("a.rawlog"));
  for (const Scan& scan : scans)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(samePoints(scan, frame->scan));
    EXPECT_EQ(scan.time, frame->scan.time);
    EXPECT_EQ(scan.ring, frame->scan.ring);
    EXPECT_FALSE(frame->T_world_vehicle_truth);
  }
  EXPECT_FALSE(source.next());
}

TEST_P(RawlogRoundTrip, KeepsInvalidPointsAndEmptyScans)
{
  const TestFolder folder;
  RawlogWriterOptions options;
  options.external_storage = GetParam();
  Scan odd = someScan(1, 1);
  odd.points = {{nan, 1, 2}, {inf, -inf, 0}, {0, 0, 0}, {1, 2, 3}, {nan, nan, nan}};
  odd.intensity = {0, 1, nan, 0.5F, 0};
  Scan plain = someScan(3, 4);
  plain.intensity.clear();
  {
    RawlogWriter writer(folder.file("a.rawlog"), options);
    writer.write(someScan(0, 10));
    writer.write(odd);
    writer.write(someScan(2, 0));
    writer.write(plain);
    writer.close();
  }
  RawlogSource source(folder.file("a.rawlog"));
  ASSERT_TRUE(source.next());
  const auto invalid = source.next();
  ASSERT_TRUE(invalid);
  EXPECT_TRUE(samePoints(odd, invalid->scan));
  EXPECT_EQ(5U, invalid->scan.intensity.size());
  const auto empty = source.next();
  ASSERT_TRUE(empty);
  EXPECT_EQ(2U, empty->index);
  EXPECT_EQ(0U, empty->scan.size());
  const auto last = source.next();
  ASSERT_TRUE(last);
  EXPECT_TRUE(samePoints(plain, last->scan));
  EXPECT_TRUE(last->scan.intensity.empty());
  ASSERT_EQ(1U, source.warnings().size());
  EXPECT_TRUE(contains(source.warnings().front(), "empty scan"));
}
INSTANTIATE_TEST_SUITE_P(Storage, RawlogRoundTrip, ::testing::Bool());

TEST(RawlogSource, SkipsAndLimits)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 10);
  RawlogSourceOptions options;
  options.skip_first_n = 3;
  options.only_first_n = 4;
  RawlogSource source(folder.file("a.rawlog"), options);
  for (std::size_t i = 3; i < 7; ++i)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(i, frame->index);
    EXPECT_EQ(50 + i, frame->scan.size());
  }
  EXPECT_FALSE(source.next());
  EXPECT_EQ(4U, source.framesRead());

  options.skip_first_n = 10;
  const auto message =
      messageOfError<UserError>([&] { const RawlogSource none(folder.file("a.rawlog"), options); });
  EXPECT_TRUE(contains(message, "skip_first_n = 10")) << message;
  options.skip_first_n = -1;
  EXPECT_THROW(RawlogSource(folder.file("a.rawlog"), options), UserError);
}

TEST(RawlogSource, TakesARangeOfTime)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 10);
  std::vector<double> stamps;
  RawlogSource all(folder.file("a.rawlog"));
  while (const auto frame = all.next())
  {
    stamps.push_back(frame->scan.stamp);
  }
  ASSERT_EQ(10U, stamps.size());
  RawlogSourceOptions options;
  options.start = stamps[3] - stamps[0];
  options.end = stamps[6] - stamps[0];
  // Damage behind the end is not met.
  const std::string whole = folder.read("a.rawlog");
  RawlogSource source(folder.write("cut.rawlog", whole.substr(0, whole.size() - 20)), options);
  for (std::size_t i = 3; i < 6; ++i)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(i, frame->index);
    EXPECT_EQ(stamps[i], frame->scan.stamp);
  }
  EXPECT_FALSE(source.next());

  options.start = 1000;
  options.end = 0;
  const auto message =
      messageOfError<UserError>([&] { const RawlogSource none(folder.file("a.rawlog"), options); });
  EXPECT_TRUE(contains(message, "start = 1000 s")) << message;
  EXPECT_TRUE(contains(message, "the file has 10 scans, the last ")) << message;
  options.end = 999;
  EXPECT_THROW(RawlogSource(folder.file("a.rawlog"), options), UserError);
}

TEST(RawlogSource, ChoosesTheSensor)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (std::size_t i = 0; i < 6; ++i)
    {
      Scan scan = someScan(i, 10 + i);
      scan.sensor_label = i % 2 == 0 ? "front" : "rear";
      scan.ring.assign(scan.size(), static_cast<std::uint16_t>(i));
      writer.write(scan);
    }
    writer.close();
  }
  RawlogSourceOptions options;
  RawlogSource first(folder.file("a.rawlog"), options);
  std::size_t frames = 0;
  while (const auto frame = first.next())
  {
    EXPECT_EQ("front", frame->scan.sensor_label);
    EXPECT_EQ(frames, frame->index);
    EXPECT_EQ(2 * frames, frame->scan.ring.front());
    ++frames;
  }
  EXPECT_EQ(3U, frames);
  ASSERT_EQ(1U, first.warnings().size());
  EXPECT_TRUE(contains(first.warnings().front(), "'rear'"));

  options.sensor_label = "re.*";
  RawlogSource rear(folder.file("a.rawlog"), options);
  EXPECT_EQ("rear", rear.next()->scan.sensor_label);
  EXPECT_EQ("rear", rear.sensorLabel());

  options.sensor_label = "roof";
  auto message = messageOfError<UserError>([&] { RawlogSource(folder.file("a.rawlog"), options); });
  EXPECT_TRUE(contains(message, "'front', 'rear'")) << message;
  options.sensor_label = "(";
  message = messageOfError<UserError>([&] { RawlogSource(folder.file("a.rawlog"), options); });
  EXPECT_TRUE(contains(message, "regular expression")) << message;
}

TEST(RawlogSource, BringsBigIntensitiesToOne)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (std::size_t i = 0; i < 2; ++i)
    {
      Scan scan = someScan(i, 3);
      scan.intensity = {0.0F, 51.0F, i == 0 ? 255.0F : 0.5F};
      writer.write(scan);
    }
    writer.close();
  }
  RawlogSource source(folder.file("a.rawlog"));
  EXPECT_FLOAT_EQ(0.2F, source.next()->scan.intensity[1]);
  EXPECT_FLOAT_EQ(0.5F / 255.0F, source.next()->scan.intensity[2]);
  RawlogSourceOptions options;
  options.intensity_scale = 2;
  RawlogSource scaled(folder.file("a.rawlog"), options);
  EXPECT_FLOAT_EQ(102.0F, scaled.next()->scan.intensity[1]);
}

TEST(RawlogSource, ADimFirstScanDoesNotDecideTheIntensities)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (std::size_t i = 0; i < 2; ++i)
    {
      Scan scan = someScan(i, 3);
      scan.intensity = {0.0F, 1.0F, i == 0 ? 0.5F : 51.0F};
      writer.write(scan);
    }
    writer.close();
  }
  RawlogSource source(folder.file("a.rawlog"));
  EXPECT_FLOAT_EQ(0.5F, source.next()->scan.intensity[2]);
  EXPECT_FLOAT_EQ(0.2F, source.next()->scan.intensity[2]);
}

TEST(RawlogWriter, SameInputGivesTheSameBytes)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 3);
  writeScans(folder.file("b.rawlog"), 3);
  EXPECT_EQ(folder.read("a.rawlog"), folder.read("b.rawlog"));
}

TEST(RawlogWriter, GivesTheNameOnlyToWholeFiles)
{
  const TestFolder folder;
  folder.write("a.rawlog", "an earlier one");
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    writer.write(someScan(0, 10));
    EXPECT_EQ("an earlier one", folder.read("a.rawlog"));
    EXPECT_THROW(writer.write(
                     []
                     {
                       Scan scan = someScan(1, 5);
                       scan.intensity.pop_back();
                       return scan;
                     }()),
                 std::logic_error);
    Scan timeless = someScan(1, 5);
    timeless.stamp = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(writer.write(timeless), UserError);
  }
  // What came before the error is there and whole.
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.rawlog.tmp")));
  RawlogSource source(folder.file("a.rawlog"));
  EXPECT_TRUE(source.next());
  EXPECT_FALSE(source.next());
}

TEST(RawlogWriter, NothingWrittenLeavesTheEarlierFile)
{
  const TestFolder folder;
  folder.write("a.rawlog", "an earlier one");
  {
    const RawlogWriter writer(folder.file("a.rawlog"));
  }
  EXPECT_EQ("an earlier one", folder.read("a.rawlog"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.rawlog.tmp")));
}

TEST(RawlogWriter, RemovesTheCloudsOfAnEarlierFile)
{
  const TestFolder folder;
  RawlogWriterOptions options;
  options.external_storage = true;
  const auto write = [&](std::size_t scans)
  {
    RawlogWriter writer(folder.file("a.rawlog"), options);
    for (std::size_t i = 0; i < scans; ++i)
    {
      Scan scan = someScan(i, 10);
      scan.sensor_label = "lidar";
      writer.write(scan);
    }
    writer.close();
  };
  write(4);
  const std::vector<std::string> others{"lidar_3.gz", "lidar_000003.bin", "000003.gz", "notes.gz"};
  for (const std::string& other : others)
  {
    folder.write("a_Images/" + other, "mine");
  }
  ASSERT_TRUE(std::filesystem::exists(folder.file("a_Images/lidar_000003.gz")));
  write(2);
  EXPECT_TRUE(std::filesystem::exists(folder.file("a_Images/lidar_000001.gz")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a_Images/lidar_000002.gz")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a_Images/lidar_000003.gz")));
  for (const std::string& other : others)
  {
    EXPECT_EQ("mine", folder.read("a_Images/" + other)) << other;
  }
  EXPECT_EQ(2U, readAll(folder.file("a.rawlog")).size());
  // No rawlog stays with the clouds of another, even if these cannot be installed.
  std::filesystem::remove(folder.file("a_Images/lidar_000001.gz"));
  folder.write("a_Images/lidar_000001.gz/a", "no file can replace this folder");
  EXPECT_THROW(write(3), UserError);
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.rawlog")));
}

TEST(RawlogWriter, RefusesWhatCannotBeWritten)
{
  const TestFolder folder;
  EXPECT_THROW(RawlogWriter(folder.file("none/a.rawlog")), UserError);
  EXPECT_THROW(RawlogWriter{folder.path()}, UserError);
  folder.write("file", "");
  EXPECT_THROW(RawlogWriter(folder.file("file/a.rawlog")), UserError);
  RawlogWriterOptions options;
  options.compression_level = 12;
  EXPECT_THROW(RawlogWriter(folder.file("a.rawlog"), options), UserError);
}

TEST(RawlogWriter, SaysThatTheDiskIsFullAndLeavesNothing)
{
  const TestFolder folder;
  const test::FullDisk full_disk(100000);
  {
    RawlogWriter full(folder.file("full.rawlog"));
    EXPECT_THROW(
        {
          for (std::size_t i = 0; i < 20; ++i)
          {
            full.write(someScan(i, 50000));
          }
          full.close();
        },
        UserError);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.file("full.rawlog")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("full.rawlog.tmp")));
}

TEST(ReplayWriter, NothingWrittenLeavesTheEarlierFile)
{
  const TestFolder folder;
  folder.write("a.rawlog", "an earlier one");
  {
    const ReplayWriter writer(folder.file("a.rawlog"));
  }
  EXPECT_EQ("an earlier one", folder.read("a.rawlog"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.rawlog.tmp")));
  {
    ReplayWriter writer(folder.file("a.rawlog"));
    writer.write(someFrame(100));
  }
  RawlogSource source(folder.file("a.rawlog"));
  EXPECT_TRUE(source.next());
}

TEST(ReplayWriter, SaysAtOnceThatTheDiskIsFull)
{
  const TestFolder folder;
  folder.write("a.rawlog", "an earlier one");
  const test::FullDisk full_disk;
  {
    ReplayWriterOptions options;
    options.resolution = 0;
    options.compression_level = 0;
    ReplayWriter writer(folder.file("a.rawlog"), options);
    EXPECT_THROW(writer.write(someFrame(100000)), UserError);
  }
  EXPECT_EQ("an earlier one", folder.read("a.rawlog"));
}
}  // namespace dyslam
