// SPDX-License-Identifier: BSD-3-Clause
// A rawlog that is read while it is written.
#include <dyslam/base/Error.h>
#include <dyslam/base/GrowingFile.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "SyntheticScans.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
RawlogWriterOptions growing()
{
  RawlogWriterOptions options;
  options.growing = true;
  return options;
}

/** Reads a rawlog to its end in a thread of its own. */
class Follower
{
 public:
  explicit Follower(const std::string& path) : thread_([this, path] { read(path); }) {}
  void stop() { is_stopping_ = true; }
  ~Follower()
  {
    if (thread_.joinable())
    {
      thread_.join();
    }
  }
  /** Waits until that many frames were delivered. \return whether they were, within a while */
  [[nodiscard]] bool hasRead(std::size_t count) const
  {
    for (int wait = 0; wait < 20000 && delivered_ < count && !has_ended_; ++wait)
    {
      ::usleep(1000);
    }
    return delivered_ >= count;
  }
  [[nodiscard]] bool hasEnded() const { return has_ended_; }
  /** Whether stop() has ended it, once it has ended. */
  [[nodiscard]] bool isStopped() const { return is_stopped_; }
  /** All frames, once the reader has ended. */
  const std::vector<Frame>& frames()
  {
    thread_.join();
    return frames_;
  }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void read(const std::string& path)
  {
    try
    {
      RawlogSource source(path, {}, [this] { return is_stopping_.load(); });
      while (auto frame = source.next())
      {
        frames_.push_back(std::move(*frame));
        ++delivered_;
      }
      is_stopped_ = source.isStopped();
    }
    catch (const UserError& error)
    {
      error_ = error.what();
    }
    has_ended_ = true;
  }

  std::vector<Frame> frames_;
  std::string error_;
  std::atomic<std::size_t> delivered_ = 0;
  std::atomic<bool> is_stopping_ = false;
  bool is_stopped_ = false;
  std::atomic<bool> has_ended_ = false;
  std::thread thread_;
};

/** A scan of several gzip members is read as soon as a small one. */
std::size_t pointsOf(std::size_t number)
{
  return number % 3 == 0 ? 90000 : 50;
}
}  // namespace

TEST(GrowingRawlog, EachScanIsReadOnceTheNextIsThere)
{
  const TestFolder folder;
  const std::string path = folder.file("a.rawlog");
  RawlogWriter writer(path, growing());
  constexpr std::size_t count = 8;
  std::optional<Follower> follower;
  for (std::size_t i = 0; i < count; ++i)
  {
    writer.write(someScan(i, pointsOf(i)), somePose(i));
    writer.flush();
    if (i == 0)
    {
      follower.emplace(path);
    }
    ASSERT_TRUE(follower->hasRead(i)) << i << ": " << follower->error();
    ASSERT_FALSE(follower->hasEnded());
  }
  writer.close();
  const std::vector<Frame> frames = follower->frames();
  EXPECT_EQ("", follower->error());
  ASSERT_EQ(count, frames.size());
  for (std::size_t i = 0; i < count; ++i)
  {
    EXPECT_EQ(i, frames[i].index);
    EXPECT_TRUE(samePoints(someScan(i, pointsOf(i)), frames[i].scan)) << i;
    EXPECT_TRUE(frames[i].T_world_vehicle_truth.has_value());
  }
}

TEST(GrowingRawlog, AReaderWaitsForTheFirstScan)
{
  const TestFolder folder;
  const std::string path = folder.file("a.rawlog");
  RawlogWriter writer(path, growing());
  Follower follower(path);
  writer.write(someScan(0, 10));
  writer.flush();
  writer.close();
  EXPECT_EQ(1U, follower.frames().size()) << follower.error();
}

TEST(GrowingRawlog, AReaderThatIsStoppedWhileItWaitsHasTheScansBefore)
{
  const TestFolder folder;
  const std::string path = folder.file("a.rawlog");
  RawlogWriter writer(path, growing());
  for (std::size_t i = 0; i < 3; ++i)
  {
    writer.write(someScan(i, pointsOf(i)));
    writer.flush();
  }
  Follower follower(path);
  EXPECT_TRUE(follower.hasRead(2));
  follower.stop();
  EXPECT_EQ(3U, follower.frames().size());
  EXPECT_EQ("", follower.error());
  EXPECT_TRUE(follower.isStopped());
  EXPECT_TRUE(isGrowing(path));
}

TEST(GrowingRawlog, WhatWasFlushedIsAWholeRawlog)
{
  const TestFolder folder;
  const std::string path = folder.file("a.rawlog");
  RawlogWriter writer(path, growing());
  for (std::size_t i = 0; i < 4; ++i)
  {
    writer.write(someScan(i, pointsOf(i)));
    writer.flush();
    fs::copy_file(path, folder.file("copy.rawlog"), fs::copy_options::overwrite_existing);
    EXPECT_EQ(i + 1, readAll(folder.file("copy.rawlog")).size());
  }
  EXPECT_FALSE(fs::exists(path + ".tmp"));
}

/** As if the program that records was killed. */
TEST(GrowingRawlog, AReaderEndsWithAKilledWriter)
{
  const TestFolder folder;
  const std::string path = folder.file("a.rawlog");
  int ready[2] = {};
  ASSERT_EQ(0, ::pipe(ready));
  const pid_t child = ::fork();
  if (child == 0)
  {
    RawlogWriter writer(path, growing());
    for (std::size_t i = 0; i < 5; ++i)
    {
      writer.write(someScan(i, 50));
      writer.flush();
    }
    writer.write(someScan(5, 50));  // is not flushed
    (void)!::write(ready[1], "x", 1);
    for (;;)
    {
      ::pause();
    }
  }
  ::close(ready[1]);  // so that the end of the child ends the wait
  char byte = 0;
  ASSERT_EQ(1, ::read(ready[0], &byte, 1));
  Follower follower(path);
  EXPECT_TRUE(follower.hasRead(4));
  EXPECT_FALSE(follower.hasEnded());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(5U, follower.frames().size());
  EXPECT_EQ("", follower.error());
  ::close(ready[0]);
}

TEST(GrowingRawlog, AWriteThatWasCutLosesThatScanOnly)
{
  const TestFolder folder;
  const std::string path = folder.file("a.rawlog");
  {
    RawlogWriter writer(path, growing());
    for (std::size_t i = 0; i < 3; ++i)
    {
      writer.write(someScan(i, 500));
      writer.flush();
    }
  }
  fs::resize_file(path, fs::file_size(path) - 100);
  Follower follower(path);
  EXPECT_EQ(2U, follower.frames().size());
  EXPECT_TRUE(contains(follower.error(), "is cut short")) << follower.error();
}

TEST(GrowingRawlog, ReplacesAnEarlierOneAtOnceAndIsRemovedIfAbandoned)
{
  const TestFolder folder;
  const std::string path = folder.file("a.rawlog");
  writeScans(path, 3);
  RawlogWriter writer(path, growing());
  EXPECT_EQ(0U, fs::file_size(path));
  EXPECT_THROW(RawlogWriter(path, growing()), UserError);
  writer.abandon();
  EXPECT_FALSE(fs::exists(path));
}

TEST(GrowingRawlog, HasTheScansOfAnyOther)
{
  const TestFolder folder;
  writeScans(folder.file("a.rawlog"), 4);
  writeScans(folder.file("b.rawlog"), 4, growing());
  const auto expected = readAll(folder.file("a.rawlog"));
  const auto frames = readAll(folder.file("b.rawlog"));
  ASSERT_EQ(expected.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    EXPECT_TRUE(samePoints(expected[i].scan, frames[i].scan));
    EXPECT_EQ(expected[i].scan.stamp, frames[i].scan.stamp);
  }
  EXPECT_FALSE(isGrowing(folder.file("b.rawlog")));
}
}  // namespace dyslam
