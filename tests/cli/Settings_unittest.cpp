// SPDX-License-Identifier: BSD-3-Clause
// Which settings a run uses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "RunProgram.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
const std::string campus16 = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";

/** Two scans of the bundled recording of a VLP-16. */
Outcome slam(const TestFolder& folder, const std::string& output, const std::string& flags = "")
{
  return runProgram("dyslam",
                    "-i " + campus16 + " --only-first-n 2 --set output.replay=false " + flags +
                        " -o " + folder.file(output),
                    folder.path());
}

std::vector<std::string> lines(const std::string& text)
{
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
  {
    all.push_back(line);
  }
  return all;
}

std::string settingsOf(const TestFolder& folder, const std::string& output)
{
  return contentOf(folder.file(output + "/effective.ini"));
}
}  // namespace

TEST(Settings, ThoseOfTheSensorAreTakenAndNamed)
{
  const TestFolder folder;
  const Outcome outcome = slam(folder, "run");
  EXPECT_EQ(0, outcome.code) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "dyslam: 16 rings, 2.0 deg apart, -15")) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "10.0 Hz; settings: vlp16.ini\n")) << outcome.err;
  EXPECT_FALSE(contains(outcome.err, "warning")) << outcome.err;
  EXPECT_TRUE(contains(contentOf(folder.file("run/report.json")), "\"sensor\": \"16 rings"));
  EXPECT_EQ(0, slam(folder, "named", "-c vlp16.ini").code);
  EXPECT_EQ(settingsOf(folder, "named"), settingsOf(folder, "run"));
  const std::string again = "-c " + folder.file("run/effective.ini");
  EXPECT_EQ(0, slam(folder, "again", again).code);
  EXPECT_EQ(settingsOf(folder, "again"), settingsOf(folder, "run"));
}

TEST(Settings, AMapWithoutProgressStillWarnsOfThoseOfAnotherSensor)
{
  const TestFolder folder;
  const std::string truth = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.gt/poses_tum.txt";
  const Outcome outcome =
      runProgram("dyslam-map",
                 "-q -i " + campus16 + " --trajectory " + truth +
                     " --only-first-n 2 -c kitti64.ini -o " + folder.file("map.ply"),
                 folder.path());
  EXPECT_EQ(0, outcome.code) << outcome.err;
  EXPECT_EQ(0U, outcome.err.find("warning: kitti64.ini is for sensors")) << outcome.err;
  EXPECT_FALSE(contains(outcome.err, "settings: ")) << outcome.err;
}

TEST(Settings, AnIniOfOneLineChangesOneLine)
{
  const TestFolder folder;
  ASSERT_EQ(0, slam(folder, "run").code);
  folder.write("mine.ini", "[map]\nvoxel_size = 0.77\n");
  const Outcome outcome = slam(folder, "mine", "-c " + folder.file("mine.ini"));
  EXPECT_EQ(0, outcome.code) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "settings: vlp16.ini + mine.ini")) << outcome.err;
  const auto before = lines(settingsOf(folder, "run"));
  const auto after = lines(settingsOf(folder, "mine"));
  ASSERT_EQ(before.size(), after.size());
  std::size_t changed = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
  {
    changed += before[i] == after[i] ? 0 : 1;
  }
  EXPECT_EQ(1U, changed);
}

TEST(Settings, AnIniForOtherSensorsIsAWarning)
{
  const TestFolder folder;
  const Outcome outcome = slam(folder, "run", "-c kitti64.ini --set dyseg.method=none");
  EXPECT_NE(1, outcome.code) << outcome.err;
  const auto said = lines(outcome.err);
  EXPECT_EQ(1, std::count_if(said.begin(), said.end(),
                             [](const std::string& line)
                             { return contains(line, "warning: kitti64.ini is for sensors"); }))
      << outcome.err;
  EXPECT_TRUE(contains(contentOf(folder.file("run/report.json")), "kitti64.ini is for sensors"));
}

TEST(Settings, InisOfOtherProgramsAreRefused)
{
  const TestFolder folder;
  for (const std::string name : {"train_dylo.ini", "train_dylo_simulated.ini", "train_dyseg.ini",
                                 "train_dyseg_simulated.ini", "splits.ini", "kitti_mot.ini"})
  {
    const Outcome outcome = slam(folder, "run", "-c " + name);
    EXPECT_EQ(1, outcome.code);
    EXPECT_EQ(1U, lines(outcome.err).size()) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "dyslam: " + name + ":")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, ", not for dyslam")) << outcome.err;
  }
}

TEST(Settings, EveryShippedIniIsAccepted)
{
  const TestFolder folder;
  for (const std::string name :
       {"kitti64.ini", "vlp16.ini", "solid_state.ini", "handheld.ini", "fast.ini", "paper64.ini"})
  {
    const Outcome outcome = slam(folder, name, "-c " + name + " -v ERROR");
    EXPECT_NE(1, outcome.code) << name << ": " << outcome.err;
  }
}

TEST(Settings, MissingTimesOfPointsAreSaid)
{
  const TestFolder folder;
  folder.write("in/0.bin", std::string(3200, '\0'));
  folder.write("in/1.bin", std::string(3200, '\0'));
  ASSERT_EQ(
      0, runProgram("scans2rawlog", "-q -i " + folder.file("in") + " -o " + folder.file("x.rawlog"),
                    folder.path())
             .code);
  const Outcome outcome = runProgram(
      "dyslam", "-i " + folder.file("x.rawlog") + " -o " + folder.file("run"), folder.path());
  EXPECT_TRUE(contains(outcome.err, "dyslam: no rings, 0 points a scan")) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "the points have no times: scans are not deskewed"))
      << outcome.err;
  EXPECT_TRUE(contains(contentOf(folder.file("run/report.json")), "the points have no times"));
  EXPECT_TRUE(contains(outcome.err, "warning: no point of the first 2 scans is a return"))
      << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "; check the recording, and how it was converted"))
      << outcome.err;
}

/** A copy of the program in a prefix that DySLAM was not configured for. */
TEST(Settings, WithoutTheShippedOnesNothingRuns)
{
  namespace fs = std::filesystem;
  const TestFolder folder;
  fs::create_directories(folder.file("bin"));
  fs::copy_file(std::string(DYSLAM_BIN_DIR) + "/dyslam", folder.file("bin/dyslam"));
  const std::string command = "env -u DYSLAM_SHARE " + folder.file("bin/dyslam") + " -i " +
                              campus16 + " --only-first-n 2 -o " + folder.file("run") + " > " +
                              folder.file("out.txt") + " 2> " + folder.file("err.txt");
  const bool ran = std::system(command.c_str()) == 0;
  const std::string err = folder.read("err.txt");
  if (ran)
  {
    EXPECT_TRUE(contains(err, "settings: vlp16.ini")) << "those that are installed";
    return;
  }
  EXPECT_TRUE(
      contains(err, "dyslam: the shipped settings are not found in " + folder.file("share/dyslam")))
      << err;
  EXPECT_TRUE(contains(err, "; set DYSLAM_SHARE")) << err;
  EXPECT_FALSE(fs::exists(folder.file("run")));
}

TEST(Settings, ARangeOfTimeIsProcessedAndEvaluated)
{
  const TestFolder folder;
  const Outcome outcome =
      runProgram("dyslam", "-i " + campus16 + " --start 0.25 --end 0.55 -o " + folder.file("run"),
                 folder.path());
  EXPECT_EQ(0, outcome.code) << outcome.err;
  const auto rows = lines(contentOf(folder.file("run/scans.csv")));
  ASSERT_EQ(4U, rows.size());
  EXPECT_EQ("3,", rows[1].substr(0, 2));
  EXPECT_EQ("5,", rows[3].substr(0, 2));
  const std::string truth = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.gt";
  const Outcome tracks =
      runProgram("dyslam-eval", "tracks --reference " + truth + " --estimate " + folder.file("run"),
                 folder.path());
  EXPECT_EQ(0, tracks.code) << tracks.err;
  EXPECT_TRUE(contains(tracks.out, "frames 3-5 of ")) << tracks.out;
  // Poses without times belong to the scans used.
  const Outcome map =
      runProgram("dyslam-map",
                 "-q -i " + campus16 + " --trajectory " + folder.file("run/trajectory_kitti.txt") +
                     " -o " + folder.file("m.pcd"),
                 folder.path());
  EXPECT_EQ(0, map.code) << map.err;
  EXPECT_TRUE(contains(map.out, "3 scans, 0 without a pose")) << map.out;
  const Outcome part = runProgram("dyslam-map",
                                  "-q --run " + folder.file("run") +
                                      " --start 0.35 --end 0.45 --keyframe-distance 0"
                                      " -o " +
                                      folder.file("part.pcd"),
                                  folder.path());
  EXPECT_EQ(0, part.code) << part.err;
  EXPECT_TRUE(contains(part.out, "1 scan, 0 without a pose")) << part.out;
  EXPECT_TRUE(contains(folder.read("part.effective.ini"), "end = 0.45"))
      << folder.read("part.effective.ini");
  const Outcome set = runProgram("dyslam-map",
                                 "-q --run " + folder.file("run") +
                                     " --set input.start=0.35 --set input.end=0.45"
                                     " --keyframe-distance 0 -o " +
                                     folder.file("set.pcd"),
                                 folder.path());
  EXPECT_EQ(0, set.code) << set.err;
  EXPECT_TRUE(contains(set.out, "1 scan, 0 without a pose")) << set.out;
  EXPECT_TRUE(contains(folder.read("set.effective.ini"), "end = 0.45"));
}

TEST(Settings, ARangeOfTimeIsExported)
{
  const TestFolder folder;
  const std::string options = "-i " + campus16 + " --no-scans -o " + folder.file("kitti");
  const Outcome outcome =
      runProgram("rawlog2kitti", options + " --start 0.25 --end 0.55", folder.path());
  EXPECT_EQ(0, outcome.code) << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "sequences/00: 3 scans")) << outcome.out;
  EXPECT_EQ(3U, lines(folder.read("kitti/sequences/00/times.txt")).size());
  EXPECT_EQ(3U, lines(folder.read("kitti/poses/00.txt")).size());
  const Outcome none =
      runProgram("rawlog2kitti", options + " --sequence 01 --start 2 --end 1", folder.path());
  EXPECT_EQ(1, none.code);
  EXPECT_TRUE(contains(none.err, "end = 1 s is not after start = 2 s")) << none.err;
}

TEST(Settings, OnlyInisOfTheProgramAreOffered)
{
  const TestFolder folder;
  const Outcome outcome = slam(folder, "run", "-c nope.ini");
  EXPECT_EQ(1, outcome.code);
  EXPECT_TRUE(contains(outcome.err, "kitti64.ini")) << outcome.err;
  EXPECT_FALSE(contains(outcome.err, "train_dylo")) << outcome.err;
  EXPECT_FALSE(contains(outcome.err, "kitti_mot")) << outcome.err;
}

TEST(Settings, AMapIsMadeWithThoseOfItsRunAndLeavesTheRunsFilesAlone)
{
  const TestFolder folder;
  ASSERT_EQ(0, slam(folder, "run", "--set map.voxel_size=0.77").code);
  const std::string map =
      "-i " + campus16 + " --trajectory " + folder.file("run/trajectory_tum.txt") + " -o ";
  const Outcome made = runProgram("dyslam-map", map + folder.file("new/m.pcd"), folder.path());
  EXPECT_EQ(0, made.code) << made.err;
  EXPECT_TRUE(contains(made.err, "settings: " + folder.file("run/effective.ini"))) << made.err;
  EXPECT_TRUE(contains(made.out, "2 scans, 0 without a pose, 1 keyframe,")) << made.out;
  EXPECT_TRUE(contains(contentOf(folder.file("new/m.effective.ini")), "voxel_size = 0.77"));

  const std::string picture = contentOf(folder.file("run/map.png"));
  const Outcome refused = runProgram("dyslam-map", map + folder.file("run/map.png"), folder.path());
  EXPECT_EQ(1, refused.code);
  EXPECT_TRUE(contains(refused.err, "map.png: is a file of the run")) << refused.err;
  EXPECT_EQ(picture, contentOf(folder.file("run/map.png")));
  const std::string force = folder.file("run/map.png") + " --force";
  EXPECT_EQ(0, runProgram("dyslam-map", map + force, folder.path()).code);
  EXPECT_NE(picture, contentOf(folder.file("run/map.png")));
}

TEST(Settings, AMapIsMadeOfTheFolderOfARun)
{
  const TestFolder folder;
  ASSERT_EQ(0, slam(folder, "run", "--labels --set map.voxel_size=0.77").code);
  const std::string trajectory = " --trajectory " + folder.file("run/trajectory_tum.txt");
  const std::string labels = " --labels " + folder.file("run/labels");
  const Outcome flags =
      runProgram("dyslam-map",
                 "-i " + campus16 + trajectory + labels + " --tracks " +
                     folder.file("run/tracks.txt") + " -o " + folder.file("flags.las"),
                 folder.path());
  EXPECT_EQ(0, flags.code) << flags.err;
  const std::string of_run = "--run " + folder.file("run");
  const Outcome made =
      runProgram("dyslam-map", of_run + " -o " + folder.file("run.las"), folder.path());
  EXPECT_EQ(0, made.code) << made.err;
  EXPECT_TRUE(contains(made.err, "settings: " + folder.file("run/effective.ini"))) << made.err;
  EXPECT_EQ(contentOf(folder.file("flags.las")), contentOf(folder.file("run.las")));
  EXPECT_TRUE(contains(contentOf(folder.file("run.effective.ini")), "voxel_size = 0.77"));

  const std::string report = folder.file("run/report.json");
  const std::string moved = folder.write("run/report.json", "{\"input\": \"/moved/r.rawlog\"}");
  EXPECT_EQ(report, moved);
  const auto refusal = [&](const std::string& arguments)
  {
    const Outcome outcome =
        runProgram("dyslam-map", arguments + " -o " + folder.file("never.las"), folder.path());
    EXPECT_EQ(1, outcome.code);
    EXPECT_EQ(1U, lines(outcome.err).size()) << outcome.err;
    return outcome.err;
  };
  const std::string lost = refusal(of_run);
  EXPECT_TRUE(contains(lost, "/moved/r.rawlog: the recording of ")) << lost;
  EXPECT_TRUE(contains(lost, "give --input RECORDING")) << lost;
  const Outcome given = runProgram(
      "dyslam-map", of_run + " -i " + campus16 + " -o " + folder.file("given.las"), folder.path());
  EXPECT_EQ(0, given.code) << given.err;
  EXPECT_EQ(contentOf(folder.file("flags.las")), contentOf(folder.file("given.las")));
  EXPECT_TRUE(contains(refusal(of_run + " --merge a b"), "--run"));
  EXPECT_TRUE(contains(refusal(of_run + " --poses-of lidar"), "--trajectory"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("never.las")));
}

TEST(Settings, APictureDoesNotReplaceTheImageOfAGrid)
{
  const TestFolder folder;
  const std::string map = "-q -i " + campus16 + " --only-first-n 2 --trajectory " +
                          DYSLAM_SOURCE_DIR + "/rawlog/campus16.gt/poses_tum.txt ";
  const std::string grid = folder.file("m.png");
  ASSERT_EQ(0, runProgram("dyslam-map", map + "-o " + grid, folder.path()).code);
  const std::string image = contentOf(grid);
  for (const char* flag : {"--picture ", "--compare "})
  {
    const Outcome refused = runProgram("dyslam-map", map + flag + grid, folder.path());
    EXPECT_EQ(1, refused.code);
    EXPECT_EQ(1U, lines(refused.err).size()) << refused.err;
    EXPECT_TRUE(contains(refused.err, "m.png: is the image of the occupancy grid ")) << refused.err;
    EXPECT_EQ(image, contentOf(grid));
  }
  const std::string picture = folder.file("picture.png");
  EXPECT_EQ(0, runProgram("dyslam-map", map + "--picture " + picture, folder.path()).code);
  EXPECT_EQ(0, runProgram("dyslam-map", map + "--picture " + picture, folder.path()).code);
}
}  // namespace dyslam
