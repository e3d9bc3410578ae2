// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/serialization/CArchive.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <utility>

#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** Opens and reads all; the count of frames and the message of the error, if any. */
struct Outcome
{
  std::size_t frames = 0;
  std::string error;
};

Outcome outcomeOf(const std::string& path)
{
  Outcome outcome;
  try
  {
    RawlogSource source(path);
    while (source.next())
    {
      ++outcome.frames;
    }
  }
  catch (const UserError& error)
  {
    outcome.error = error.what();
    EXPECT_TRUE(contains(outcome.error, path)) << outcome.error;
    EXPECT_FALSE(contains(outcome.error, "\n")) << outcome.error;
  }
  return outcome;
}

std::string unzipped(const std::string& path)
{
  std::string content;
  std::array<char, 4096> buffer{};
  gzFile file = gzopen(path.c_str(), "rb");
  for (int got = 0; (got = gzread(file, buffer.data(), buffer.size())) > 0;)
  {
    content.append(buffer.data(), static_cast<std::size_t>(got));
  }
  gzclose(file);
  return content;
}

template <typename... Objects>
void writeObjects(const std::string& path, const Objects&... objects)
{
  mrpt::io::CFileGZOutputStream file(path);
  auto archive = mrpt::serialization::archiveFrom(file);
  (archive << ... << objects);
}
}  // namespace

TEST(RawlogRobustness, MissingEmptyAndFolder)
{
  const TestFolder folder;
  EXPECT_TRUE(contains(outcomeOf(folder.file("none.rawlog")).error, "no such file"));
  EXPECT_TRUE(contains(outcomeOf(folder.write("a.rawlog", "")).error, "is empty"));
  EXPECT_TRUE(contains(outcomeOf(folder.path()).error, "is a folder"));
}

TEST(RawlogRobustness, GarbageIsRefused)
{
  const TestFolder folder;
  EXPECT_TRUE(contains(outcomeOf(folder.write("a", "x")).error, "a: "));
  EXPECT_TRUE(
      contains(outcomeOf(folder.write("b", std::string(100000, 'q'))).error, "not a rawlog"));
  EXPECT_TRUE(contains(outcomeOf(folder.write("c", "# .PCD v0.7 - Point Cloud Data\nVERSION 0.7\n" +
                                                       std::string(300, ' ')))
                           .error,
                       "not a rawlog"));
  std::string noise;
  unsigned state = 12345;
  for (int i = 0; i < 5000; ++i)
  {
    state = state * 1664525U + 1013904223U;
    noise += static_cast<char>(state >> 24U);
  }
  EXPECT_FALSE(outcomeOf(folder.write("d", noise)).error.empty());
}

TEST(RawlogRobustness, PlainUncompressedIsRead)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 4);
  const std::string path = folder.write("plain.rawlog", unzipped(folder.file("a.rawlog")));
  const Outcome outcome = outcomeOf(path);
  EXPECT_EQ(4U, outcome.frames);
  EXPECT_EQ("", outcome.error);
}

TEST(RawlogRobustness, CutFilesDeliverWhatIsWholeAndThenSayIt)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 6);
  for (const bool plain : {false, true})
  {
    const std::string whole = plain ? unzipped(folder.file("a.rawlog")) : folder.read("a.rawlog");
    std::size_t most = 0;
    for (std::size_t size = 1; size < whole.size(); size += 37)
    {
      const Outcome outcome = outcomeOf(folder.write("cut.rawlog", whole.substr(0, size)));
      // Between two objects a plain file cannot know that more should follow.
      if (!plain)
      {
        EXPECT_FALSE(outcome.error.empty()) << size;
      }
      EXPECT_GE(outcome.frames, most) << size;
      most = std::max(most, outcome.frames);
    }
    EXPECT_GE(most, 5U);
  }
  const std::string whole = folder.read("a.rawlog");
  const Outcome late =
      outcomeOf(folder.write("late.rawlog", whole.substr(0, whole.size() - whole.size() / 12)));
  EXPECT_TRUE(contains(late.error, "is cut short")) << late.error;
  EXPECT_GE(late.frames, 4U);
}

TEST(RawlogRobustness, FlippedBytesNeverCrash)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 3);
  for (const bool plain : {false, true})
  {
    const std::string whole = plain ? unzipped(folder.file("a.rawlog")) : folder.read("a.rawlog");
    for (std::size_t at = 0; at < whole.size(); at += plain ? 61 : 17)
    {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
      const Outcome outcome = outcomeOf(folder.write("damaged.rawlog", damaged));
      EXPECT_LE(outcome.frames, 3U);
    }
  }
}

/** Two rawlogs in one file, as `cat` writes them; the second one begins where an object does. */
TEST(RawlogRobustness, WhatFollowsTheCompressedDataIsReported)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 3);
  const std::string whole = folder.read("a.rawlog");
  std::string damaged = whole;
  damaged[0] = 'x';
  for (const auto& [second, frames] : {std::pair(whole, 6U), std::pair(damaged, 3U)})
  {
    RawlogSource source(folder.write("b.rawlog", whole + second));
    std::size_t read = 0;
    while (source.next())
    {
      ++read;
    }
    EXPECT_LE(read, frames);
    const std::vector<std::string> warnings = source.warnings();
    const bool is_reported = std::any_of(
        warnings.begin(), warnings.end(),
        [&](const std::string& line)
        {
          return contains(line, "b.rawlog: is not read from byte " + std::to_string(whole.size()) +
                                    " of " + std::to_string(2 * whole.size()) + " on");
        });
    EXPECT_EQ(is_reported, frames == 3);
  }
}

/** Not taken for a file of another version of MRPT. */
TEST(RawlogRobustness, OverwrittenBytesAreDamage)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 6);
  const std::string whole = folder.read("a.rawlog");
  constexpr std::size_t header = 32;  // of gzip, and the beginning of the data
  constexpr std::size_t length = 16;
  for (const char byte : {'\0', '\xA5', '\xFF', 't'})
  {
    for (std::size_t at = header; at + length < whole.size(); at += 29)
    {
      std::string damaged = whole;
      damaged.replace(at, length, length, byte);
      if (damaged == whole)
      {
        continue;
      }
      const std::string error = outcomeOf(folder.write("damaged.rawlog", damaged)).error;
      EXPECT_TRUE(contains(error, "damaged") || contains(error, "is cut short"))
          << at << ": " << error;
      EXPECT_FALSE(contains(error, "newer MRPT")) << at << ": " << error;
    }
  }
}

TEST(RawlogRobustness, RotatingScansMustHaveTheRowsTheySay)
{
  const TestFolder folder;
  for (const unsigned rows : {16U, 32U})
  {
    mrpt::obs::CObservationRotatingScan scan;
    scan.timestamp = mrpt::Clock::fromDouble(1.0);
    scan.sensorLabel = "velodyne";
    scan.rowCount = 16;
    scan.columnCount = 4;
    scan.rangeResolution = 0.002;
    scan.rangeImage.resize(rows, 4);
    scan.rangeImage.fill(5000);
    writeObjects(folder.file("a.rawlog"), scan);
    const Outcome outcome = outcomeOf(folder.file("a.rawlog"));
    EXPECT_EQ(rows == 16 ? 1U : 0U, outcome.frames);
    EXPECT_EQ(rows != 16, contains(outcome.error, "says 16 rows, but its range image has 32"))
        << outcome.error;
  }
}

TEST(RawlogRobustness, OtherMrptFilesAreRefused)
{
  const TestFolder folder;
  writeObjects(folder.file("a.simplemap"), mrpt::maps::CSimpleMap());
  const Outcome outcome = outcomeOf(folder.file("a.simplemap"));
  EXPECT_TRUE(contains(outcome.error, "CSimpleMap")) << outcome.error;
}

TEST(RawlogRobustness, WithoutScansSaysWhatThereIs)
{
  const TestFolder folder;
  mrpt::obs::CObservation2DRangeScan flat;
  writeObjects(folder.file("flat.rawlog"), flat, flat, mrpt::obs::CObservationOdometry());
  Outcome outcome = outcomeOf(folder.file("flat.rawlog"));
  EXPECT_TRUE(contains(outcome.error, "no 3D scans")) << outcome.error;
  EXPECT_TRUE(contains(outcome.error, "2 CObservation2DRangeScan")) << outcome.error;
  EXPECT_TRUE(contains(outcome.error, "2D scans cannot be used")) << outcome.error;

  writeObjects(folder.file("odometry.rawlog"), mrpt::obs::CObservationOdometry());
  outcome = outcomeOf(folder.file("odometry.rawlog"));
  EXPECT_TRUE(contains(outcome.error, "1 CObservationOdometry")) << outcome.error;
  EXPECT_FALSE(contains(outcome.error, "2D")) << outcome.error;
}

TEST(RawlogRobustness, RepeatedAndBackwardStampsAreDropped)
{
  const TestFolder folder;
  const std::vector<double> stamps{1.0, 1.1, 1.1, 1.2, 0.5, 1.15, 1.3};
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (std::size_t i = 0; i < stamps.size(); ++i)
    {
      Scan scan = someScan(i, 10 + i);
      scan.stamp = stamps[i];
      scan.ring.assign(scan.size(), static_cast<std::uint16_t>(i));
      writer.write(scan, somePose(i));
    }
    writer.close();
  }
  RawlogSource source(folder.file("a.rawlog"));
  std::vector<std::size_t> indices;
  while (const auto frame = source.next())
  {
    indices.push_back(frame->index);
    EXPECT_EQ(10 + frame->index, frame->scan.size());
    ASSERT_EQ(frame->scan.size(), frame->scan.ring.size());
    EXPECT_EQ(frame->index, frame->scan.ring.front());
  }
  EXPECT_EQ((std::vector<std::size_t>{0, 1, 3, 6}), indices);
  EXPECT_EQ(3U, source.framesDropped());
  ASSERT_EQ(2U, source.warnings().size());
  EXPECT_TRUE(contains(source.warnings()[0], "time stamp of the one before was dropped (scan 2)"))
      << source.warnings()[0];
  EXPECT_TRUE(contains(source.warnings()[1], "goes back was dropped (2 times, first scan 4)"))
      << source.warnings()[1];
}

TEST(RawlogRobustness, AWarningNamesItsScan)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (std::size_t i = 0; i < 8; ++i)
    {
      writer.write(someScan(i, i == 3 || i == 5 ? 0 : 10));
    }
    writer.close();
  }
  RawlogSource source(folder.file("a.rawlog"));
  while (source.next())
  {
  }
  ASSERT_EQ(source.warnings().size(), 1U);
  EXPECT_TRUE(contains(source.warnings()[0], "an empty scan (2 times, first scan 3)"))
      << source.warnings()[0];
}

/** 20 scans with their truth; the clock is set back after ten. */
void writeStep(const std::string& path, double step)
{
  RawlogWriter writer(path);
  for (std::size_t i = 0; i < 20; ++i)
  {
    Scan scan = someScan(i, 10);
    scan.stamp = 100 + 0.1 * static_cast<double>(i) - (i < 10 ? 0 : step);
    writer.write(scan, somePose(i));
  }
  writer.close();
}

TEST(RawlogRobustness, GroundTruthIsKeptWhereTheClockIsSetBack)
{
  const TestFolder folder;
  for (const double step : {2.0, 0.5})
  {
    writeStep(folder.file("a.rawlog"), step);
    RawlogSource source(folder.file("a.rawlog"));
    std::size_t frames = 0;
    for (; const auto frame = source.next(); ++frames)
    {
      ASSERT_TRUE(frame->T_world_vehicle_truth) << frame->index << ", step " << step;
      EXPECT_TRUE(frame->T_world_vehicle_truth->isApprox(somePose(frame->index), 1e-9))
          << frame->index << ", step " << step;
    }
    EXPECT_EQ(frames, 17U);
  }
}

TEST(RawlogRobustness, AClockThatIsSetBackIsBridged)
{
  const TestFolder folder;
  writeStep(folder.file("a.rawlog"), 2);
  RawlogSource source(folder.file("a.rawlog"));
  std::vector<double> stamps;
  std::vector<std::size_t> indices;
  while (const auto frame = source.next())
  {
    stamps.push_back(frame->scan.stamp);
    indices.push_back(frame->index);
  }
  // Three scans show that the times run on from there; the fourth is used.
  ASSERT_EQ(stamps.size(), 17U);
  EXPECT_EQ(indices[10], 13U);
  EXPECT_NEAR(stamps[9], 100.9, 1e-6);
  for (std::size_t i = 10; i < stamps.size(); ++i)
  {
    EXPECT_NEAR(stamps[i], 100 + 0.1 * static_cast<double>(i + 3), 1e-6);
  }
  std::string told;
  for (const std::string& line : source.warnings())
  {
    told += line + '\n';
  }
  EXPECT_TRUE(contains(told, "set back; stamps from there on are 2.000 s later")) << told;
}

TEST(RawlogRobustness, StampsThatStandStillAreAnError)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (std::size_t i = 0; i < 30; ++i)
    {
      Scan scan = someScan(i, 10);
      scan.stamp = i < 3 ? scan.stamp : 100.2;
      writer.write(scan);
    }
    writer.close();
  }
  const Outcome outcome = outcomeOf(folder.file("a.rawlog"));
  EXPECT_EQ(3U, outcome.frames);
  EXPECT_TRUE(contains(outcome.error, "stand still or run backwards from scan 3")) << outcome.error;
}

TEST(RawlogRobustness, LongLabelsAreNoMatchAndPrintedWithoutEscapeCodes)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (const std::string& label :
         {std::string(300000, 'a'), std::string("velodyne"), std::string("b\x1b[2J")})
    {
      Scan scan = someScan(label.size(), 10);
      scan.stamp = 100 + 0.1 * static_cast<double>(label.size() % 1000);
      scan.sensor_label = label;
      writer.write(scan);
    }
    writer.close();
  }
  RawlogSourceOptions options;
  options.sensor_label = "(a*)*b?.*|velodyne";
  RawlogSource source(folder.file("a.rawlog"), options);
  EXPECT_EQ("velodyne", source.sensorLabel());
  while (source.next())
  {
  }
  std::string told;
  for (const std::string& line : source.warnings())
  {
    told += line;
  }
  EXPECT_TRUE(contains(told, "'b?[2J'")) << told;
  options.sensor_label = std::string(100000, '(');
  EXPECT_THROW(RawlogSource(folder.file("a.rawlog"), options), UserError);
}
// What ends such an object may look like the length of a name, followed by the name of the next.
TEST(RawlogRobustness, ObjectsOfOtherKindsMayEndInAnyBytes)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 4);
  for (int length = 1; length < 120; ++length)
  {
    mrpt::obs::CObservationComment comment;
    comment.timestamp = mrpt::Clock::now();
    std::string ending(8, 'x');
    ending += "\x88" + std::string(1, static_cast<char>(0x80 + length));
    comment.text = ending + "1234567";
    comment.sensorLabel = ending + "1234567";
    {
      mrpt::io::CFileGZOutputStream out(folder.file("comment"));
      auto archive = mrpt::serialization::archiveFrom(out);
      archive << comment;
    }
    const Outcome outcome = outcomeOf(folder.write(
        "b.rawlog", unzipped(folder.file("comment")) + unzipped(folder.file("a.rawlog"))));
    EXPECT_EQ(4U, outcome.frames) << length;
    EXPECT_EQ("", outcome.error) << length;
  }
}
}  // namespace dyslam
