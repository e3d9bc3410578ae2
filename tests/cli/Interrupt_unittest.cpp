// SPDX-License-Identifier: BSD-3-Clause
// Ctrl-C during a conversion: a message, and no partial file; while a bag is unpacked: no temporary
// file; during a run: all results so far, and a checkpoint.
#include <dyslam/formats/ScanFiles.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "BagWriters.h"
#include "InterruptProgram.h"
#include "RunProgram.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
TEST(Interrupt, AConversionSaysAWordAndLeavesNothing)
{
  const TestFolder folder;
  // Many links to one scan: the conversion takes longer than the test waits.
  fs::create_directories(folder.file("in"));
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 20000; ++i)
  {
    points.emplace_back(std::sin(0.37F * static_cast<float>(i)) * 40, static_cast<float>(i % 91),
                        1);
  }
  writeBin(folder.file("scan.bin"), points);
  for (int i = 0; i < 20000; ++i)
  {
    fs::create_hard_link(folder.file("scan.bin"), folder.file("in/" + std::to_string(i) + ".bin"));
  }
  folder.write("x.rawlog", "an earlier one");
  const std::string bin = DYSLAM_BIN_DIR;
  const int code = interrupted({bin + "/scans2rawlog", "-q", "--force", "-i", folder.file("in"),
                                "-o", folder.file("x.rawlog")},
                               folder.file("err.txt"), folder.file("x.rawlog.tmp"));
  const std::string said = folder.read("err.txt");
  EXPECT_EQ(1, code) << said;
  EXPECT_TRUE(contains(said, "scans2rawlog: " + folder.file("in") + ": stopped after ")) << said;
  EXPECT_TRUE(contains(said, "x.rawlog was not written")) << said;
  EXPECT_FALSE(fs::exists(folder.file("x.rawlog.tmp")));
  EXPECT_EQ("an earlier one", folder.read("x.rawlog"));
}

/** As rosbag2 compresses a recording: it is unpacked before anything else. */
TEST(Interrupt, ABagThatIsUnpackedLeavesNothing)
{
  const TestFolder folder;
  const std::string megabyte = test::zstdOf(std::string(1U << 20U, 'x'));
  std::string packed;
  for (int i = 0; i < 4000; ++i)  // takes longer than the test waits
  {
    packed += megabyte;
  }
  const std::string bag = folder.write("drive.mcap.zstd", packed);
  fs::create_directories(folder.file("tmp"));
  const auto isUnpacking = [&folder]
  {
    const fs::recursive_directory_iterator entries(folder.file("tmp"));
    return std::any_of(begin(entries), end(entries),
                       [](const fs::directory_entry& entry) { return entry.is_regular_file(); });
  };
  const std::string bin = DYSLAM_BIN_DIR;
  const std::vector<std::vector<std::string>> commands{
      {bin + "/scans2rawlog", "--list", "-i", bag},
      {bin + "/scans2rawlog", "-i", bag, "-o", folder.file("x.rawlog")},
      {bin + "/dyslam", "-i", bag, "-o", folder.file("run")}};
  for (const auto& command : commands)
  {
    std::vector<std::string> words{"/usr/bin/env", "TMPDIR=" + folder.file("tmp")};
    words.insert(words.end(), command.begin(), command.end());
    const int code = interrupted(words, folder.file("err.txt"), isUnpacking);
    const std::string said = folder.read("err.txt");
    EXPECT_EQ(1, code) << said;
    EXPECT_TRUE(contains(said, ": " + bag + ": is unpacked to " + folder.file("tmp/dyslam_")))
        << said;
    EXPECT_TRUE(contains(said, ": " + bag + ": stopped while it was unpacked\n")) << said;
    EXPECT_TRUE(fs::is_empty(folder.file("tmp")));
    EXPECT_FALSE(fs::exists(folder.file("x.rawlog.tmp")));
  }
}

TEST(Interrupt, ARunKeepsItsResultsAndCanBeResumed)
{
  const TestFolder folder;
  const std::string bin = DYSLAM_BIN_DIR;
  const std::string recording = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";
  const std::string run = folder.file("run");
  const auto said = [&](const std::string& program, const std::string& arguments)
  { return runProgram(program, arguments, folder.file(".")); };
  const std::string settings =
      "-q -c vlp16.ini --labels --set labels.window=3 --only-first-n 60 -i " + recording;
  EXPECT_EQ(0, said("dyslam", settings + " -o " + folder.file("w/run")).code);
  const int code =
      interrupted({bin + "/dyslam", "-q", "-c", "vlp16.ini", "--labels", "--set", "labels.window=3",
                   "--only-first-n", "60", "-i", recording, "-o", run},
                  folder.file("err.txt"), run + "/labels/000005.label");
  const std::string err = folder.read("err.txt");
  EXPECT_EQ(1, code) << err;
  EXPECT_TRUE(contains(err, "dyslam: " + recording + ": stopped on request after ")) << err;
  EXPECT_TRUE(contains(err, "; continue with: dyslam --resume -o " + run + "\n")) << err;
  const std::string report = folder.read("run/report.json");
  EXPECT_TRUE(contains(report, "\"finished\": false")) << report;
  EXPECT_TRUE(contains(report, "\"the run is not complete: stopped on request")) << report;

  const Outcome scores = said("dyslam-eval", "run " + run);
  EXPECT_TRUE(contains(scores.err, "; stopped on request after ")) << scores.err;
  EXPECT_TRUE(contains(scores.err, "; continue with: dyslam --resume -o " + run)) << scores.err;
  const Outcome anew = said("dyslam", settings + " -o " + run);
  EXPECT_EQ(1, anew.code);
  EXPECT_TRUE(contains(anew.err, "has the checkpoint of an unfinished run")) << anew.err;

  const Outcome resumed = said("dyslam", "-q --resume -o " + run);
  EXPECT_EQ(0, resumed.code) << resumed.err;
  EXPECT_TRUE(contains(folder.read("run/report.json"), "\"finished\": true"));
  for (const std::string file :
       {"trajectory_tum.txt", "tracks.csv", "replay.rawlog", "map_static.ply"})
  {
    EXPECT_TRUE(folder.read("w/run/" + file) == folder.read("run/" + file)) << file;
  }
}
}  // namespace dyslam
