// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/batch/Manifest.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>

#include "TestFolder.h"

namespace dyslam::batch
{
namespace
{
Manifest doneIn(const TestFolder& folder, const Work& work)
{
  folder.write("report.json", "{}");
  folder.write("effective.ini", "[output]\n");
  Manifest m;
  m.work = work;
  m.state = State::done;
  m.attempts = 2;
  m.seconds = 1.5;
  m.peak_memory = 123456789;
  m.settings_checksum = checksumOfFile(folder.file("effective.ini"));
  writeManifest(folder.path(), m);
  return m;
}

Work common()
{
  Work work;
  work.settings = "--set a.b=1";
  work.version = "1.2";
  work.program_checksum = "abc";
  return work;
}
}  // namespace

TEST(Manifest, ChecksumsAreThoseOfSha256sum)
{
  const TestFolder folder;
  EXPECT_EQ(checksumOfFile(folder.write("abc", "abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(checksumOfText("abc"), checksumOfFile(folder.file("abc")));
  EXPECT_THROW((void)checksumOfFile(folder.file("none")), UserError);
}

TEST(Manifest, ComesBackAsWritten)
{
  const TestFolder folder;
  const std::string input = folder.write("x.rawlog", "scans");
  const Manifest m = doneIn(folder, workOn(input, common(), std::nullopt));
  const auto read = readManifest(folder.path());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->state, State::done);
  EXPECT_EQ(read->attempts, 2);
  EXPECT_EQ(read->seconds, 1.5);
  EXPECT_EQ(read->peak_memory, 123456789U);
  EXPECT_TRUE(isDone(folder.path(), m.work, read));
  folder.write("manifest.json", "{\"state\": \"done\"");
  EXPECT_FALSE(readManifest(folder.path()));
}

TEST(Manifest, WorkIsDoneOnlyIfNothingChanged)
{
  const TestFolder folder;
  const std::string input = folder.write("x.rawlog", "scans");
  const Work work = workOn(input, common(), std::nullopt);
  const Manifest m = doneIn(folder, work);
  ASSERT_TRUE(isDone(folder.path(), work, m));
  for (const auto& change :
       std::vector<std::function<void(Work&)>>{
           [](Work& w) { w.settings = "--set a.b=2"; }, [](Work& w) { w.version = "1.3"; },
           [](Work& w) { w.program_checksum = "abd"; }, [](Work& w) { w.input_checksum = "0"; }})
  {
    Work other = work;
    change(other);
    EXPECT_FALSE(isDone(folder.path(), other, m));
  }
  folder.write("effective.ini", "[output] changed");
  EXPECT_FALSE(isDone(folder.path(), work, m));
  doneIn(folder, work);
  std::filesystem::remove(folder.file("report.json"));
  EXPECT_FALSE(isDone(folder.path(), work, m));
}

TEST(Manifest, AMovedOrTouchedInputOfSameContentIsTheSameWork)
{
  const TestFolder folder;
  const std::string input = folder.write("x.rawlog", "scans");
  const Manifest m = doneIn(folder, workOn(input, common(), std::nullopt));
  std::filesystem::last_write_time(
      input, std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_TRUE(isDone(folder.path(), workOn(input, common(), m), m));
  folder.write("x.rawlog", "other");
  std::filesystem::last_write_time(
      input, std::filesystem::file_time_type::clock::now() + std::chrono::hours(2));
  EXPECT_FALSE(isDone(folder.path(), workOn(input, common(), m), m));
}

TEST(Manifest, AFolderIsAllOfItsFiles)
{
  const TestFolder folder;
  folder.write("drive/a.mcap", "one");
  folder.write("drive/more/b.mcap", "two");
  const Work work = workOn(folder.file("drive"), common(), std::nullopt);
  EXPECT_EQ(work.external_bytes, 6U);
  const Manifest m = doneIn(folder, work);
  EXPECT_TRUE(isDone(folder.path(), workOn(folder.file("drive"), common(), m), m));
  folder.write("drive/more/b.mcap", "2wo");
  std::filesystem::last_write_time(
      folder.file("drive/more/b.mcap"),
      std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_FALSE(isDone(folder.path(), workOn(folder.file("drive"), common(), m), m));
}

TEST(Manifest, ExternalFilesAreOfTheInput)
{
  const TestFolder folder;
  const std::string input = folder.write("x.rawlog", "scans");
  for (const std::string external : {"x_imgs", "x_img", "x_images", "x_Images"})
  {
    folder.write(external + "/1.bin", "one");
    const Work before = workOn(input, common(), std::nullopt);
    folder.write(external + "/1.bin", "two");
    EXPECT_NE(workOn(input, common(), std::nullopt).input_checksum, before.input_checksum)
        << external;
  }
}

TEST(Manifest, ReplacedExternalFilesAreNoticedBesideAnUnchangedRawlog)
{
  const TestFolder folder;
  const std::string input = folder.write("x.rawlog", "scans");
  const std::string scan = folder.write("x_Images/deep/1.bin", "one");
  doneIn(folder, workOn(input, common(), std::nullopt));
  const auto known = readManifest(folder.path());
  ASSERT_TRUE(known);
  EXPECT_TRUE(isDone(folder.path(), workOn(input, common(), known), known));

  const auto time = std::filesystem::last_write_time(scan);
  folder.write("x_Images/deep/1.bin", "two");
  std::filesystem::last_write_time(scan, time + std::chrono::hours(1));
  EXPECT_FALSE(isDone(folder.path(), workOn(input, common(), known), known)) << "time";

  folder.write("x_Images/deep/1.bin", "three");
  std::filesystem::last_write_time(scan, time);
  EXPECT_FALSE(isDone(folder.path(), workOn(input, common(), known), known)) << "size";

  folder.write("x_Images/deep/1.bin", "one");
  EXPECT_TRUE(isDone(folder.path(), workOn(input, common(), known), known)) << "as before";
  std::filesystem::remove_all(folder.file("x_Images"));
  EXPECT_FALSE(isDone(folder.path(), workOn(input, common(), known), known)) << "removed";
}

TEST(Manifest, FilesOfSameSizeAndTimeAreNotReadAgain)
{
  const TestFolder folder;
  const std::string input = folder.write("x.rawlog", "scans");
  folder.write("x_Images/1.bin", "one");
  doneIn(folder, workOn(input, common(), std::nullopt));
  auto known = readManifest(folder.path());
  ASSERT_TRUE(known);
  known->work.input_checksum = "of the manifest";
  EXPECT_EQ(workOn(input, common(), known).input_checksum, "of the manifest");
}

TEST(Manifest, ToldInterruptedRunsByTheirReasonBefore)
{
  const TestFolder folder;
  Manifest m;
  m.state = State::failed;
  m.interrupted = true;
  m.reason = "dyslam: x.rawlog: stopped on request after 3 scans";
  writeManifest(folder.path(), m);
  EXPECT_TRUE(readManifest(folder.path())->interrupted);
  for (const bool killed : {true, false})
  {
    m.reason = killed ? "ended by the signal Killed" : "dyslam: no scans";
    writeManifest(folder.path(), m);
    std::string text = folder.read("manifest.json");
    const auto begin = text.find("\"interrupted\"");
    ASSERT_NE(begin, std::string::npos) << text;
    text.erase(begin, text.find('\n', begin) + 1 - begin);
    folder.write("manifest.json", text);
    const auto known = readManifest(folder.path());
    ASSERT_TRUE(known) << text;
    EXPECT_EQ(known->interrupted, killed);
  }
}

TEST(Manifest, OfAnEarlierVersionStillCounts)
{
  const TestFolder folder;
  const std::string input = folder.write("x.rawlog", "scans");
  const Manifest m = doneIn(folder, workOn(input, common(), std::nullopt));
  std::string text = folder.read("manifest.json");
  for (const std::string key : {"\"external_bytes\"", "\"external_changed_ns\""})
  {
    const auto begin = text.find(key);
    ASSERT_NE(begin, std::string::npos) << text;
    text.erase(begin, text.find('\n', begin) + 1 - begin);
  }
  folder.write("manifest.json", text);
  const auto known = readManifest(folder.path());
  ASSERT_TRUE(known) << text;
  EXPECT_TRUE(isDone(folder.path(), workOn(input, common(), known), known));
  EXPECT_EQ(known->work.input_checksum, m.work.input_checksum);
}
}  // namespace dyslam::batch
