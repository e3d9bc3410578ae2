// SPDX-License-Identifier: BSD-3-Clause
// Runs that are stopped, fail or are refused: what they say, and what they leave in the folder.
#include <fstream>

#include "SlamRunTest.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
using SlamRunTrouble = SlamRunTest;

TEST_F(SlamRunTrouble, ATruncatedRawlogLeavesTheResultsBeforeTheCut)
{
  const std::string whole = readWhole(recording());
  const std::string cut = (folder_ / "cut.rawlog").string();
  std::ofstream(cut, std::ios::binary)
      .write(whole.data(), static_cast<long>(whole.size() * 6 / 10));
  auto s = settings("cut");
  s.rawlog = cut;
  EXPECT_NE(errorOf(s).find("cut.rawlog"), std::string::npos);
  const auto errors = errorsOf(s.output_folder);
  EXPECT_GT(errors.pairs, 15U);
  EXPECT_LT(errors.pairs, static_cast<std::size_t>(scan_count));
  const std::string report = readWhole(s.output_folder + "/report.json");
  EXPECT_NE(report.find("\"finished\": false"), std::string::npos) << report;
  EXPECT_NE(report.find("\"ended_early\": \"" + cut), std::string::npos) << report;
  EXPECT_NE(report.find("\"the run is not complete: " + cut), std::string::npos) << report;
  EXPECT_NE(readWhole(s.output_folder + "/report.html").find("the run is not complete: "),
            std::string::npos);
  EXPECT_FALSE(hasCheckpoint(s.output_folder)) << "the same damage would end it again";
}

TEST_F(SlamRunTrouble, AStoppedRunLeavesItsResults)
{
  auto s = settings("stopped");
  s.labels = false;
  s.config.set("output.checkpoint_seconds=0");
  int asked = 0;
  s.stop = [&] { return ++asked == 7; };  // the first call is before the first scan
  const std::string error = errorOf(s);
  const std::size_t scans = readTum(s.output_folder + "/trajectory_tum.txt").size();
  EXPECT_GE(scans, 6U);
  EXPECT_LE(scans, 12U) << "those in work when it was asked";
  const std::string reason = "stopped on request after " + std::to_string(scans) + " scans";
  EXPECT_EQ(error, s.rawlog + ": " + reason + ", whose results are in " + s.output_folder);
  const std::string report = readWhole(s.output_folder + "/report.json");
  EXPECT_NE(report.find("\"finished\": false"), std::string::npos) << report;
  EXPECT_NE(report.find("\"ended_early\": \"" + reason + "\""), std::string::npos) << report;
  EXPECT_NE(report.find("\"the run is not complete: " + reason + "\""), std::string::npos)
      << report;
  EXPECT_NE(readWhole(s.output_folder + "/report.html").find(reason), std::string::npos);
  EXPECT_FALSE(hasCheckpoint(s.output_folder));
}

TEST_F(SlamRunTrouble, StoppedAtTheLastScanItIsComplete)
{
  auto s = settings("at_the_end");
  s.labels = false;
  s.config.set("input.only_first_n=4");
  int asked = 0;
  s.stop = [&] { return ++asked == 5; };
  EXPECT_EQ(runSlam(s).frames, 4U);
  const std::string report = readWhole(s.output_folder + "/report.json");
  EXPECT_NE(report.find("\"finished\": true"), std::string::npos) << report;
  EXPECT_NE(report.find("\"ended_early\": \"\""), std::string::npos) << report;
  EXPECT_FALSE(hasCheckpoint(s.output_folder));
}

TEST_F(SlamRunTrouble, StoppedBeforeTheFirstScanItLeavesTheEarlierRun)
{
  auto s = settings("kept");
  s.config.set("input.only_first_n=3");
  (void)runSlam(s);
  const auto before = filesOf(s.output_folder);
  const std::string report = readWhole(s.output_folder + "/report.json");
  s.stop = [] { return true; };
  EXPECT_EQ(errorOf(s), s.rawlog + ": stopped before the first scan");
  EXPECT_EQ(before, filesOf(s.output_folder));
  EXPECT_EQ(report, readWhole(s.output_folder + "/report.json"));
}

TEST_F(SlamRunTrouble, AnEarlierRunLeavesNothingBehindInTheFolder)
{
  auto s = settings("again");
  s.static_scans = true;
  s.config.set("input.only_first_n=4");
  (void)runSlam(s);
  const fs::path folder = s.output_folder;
  ASSERT_TRUE(fs::exists(folder / "labels" / "000003.label"));
  std::ofstream(folder / "notes.txt") << "mine";
  std::ofstream(folder / "labels" / "notes.txt") << "mine";

  s.labels = false;
  s.static_scans = false;
  s.config.set("input.only_first_n=2");
  s.config.set("pipeline.mapping=false");
  (void)runSlam(s);
  EXPECT_FALSE(fs::exists(folder / "labels" / "000000.label"));
  for (const char* gone : {"static_scans", "static_scans.rawlog", "map_static.ply"})
  {
    EXPECT_FALSE(fs::exists(folder / gone)) << gone;
  }
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
  EXPECT_TRUE(fs::exists(folder / "labels" / "notes.txt"));
}

TEST_F(SlamRunTrouble, AnOutputThatFailsIsNamedAndTheOthersAreWritten)
{
  auto s = settings("one_fails");
  s.config.set("input.only_first_n=3");
  const fs::path folder = s.output_folder;
  fs::create_directories(folder / "graph.g2o" /
                         "of_the_user");  // a folder that prevents writing the file
  fs::create_directories(folder / "map.png" / "of_the_user");
  s.force = true;
  const std::string error = errorOf(s);
  EXPECT_NE(error.find("graph.g2o"), std::string::npos) << error;
  EXPECT_NE(error.find("map.png"), std::string::npos) << error;
  EXPECT_EQ(error.find("trajectory"), std::string::npos) << error;
  for (const char* written :
       {"trajectory_tum.txt", "scans.csv", "labels/000002.label", "replay.rawlog", "map_static.ply",
        "map.3Dscene", "trajectory.png", "report.html"})
  {
    EXPECT_TRUE(fs::exists(folder / written)) << written;
  }
  EXPECT_NE(readWhole(folder / "report.json").find("graph.g2o: "), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "factor_graph.txt"));
}

TEST_F(SlamRunTrouble, WhatNoRunWroteIsNotReplaced)
{
  auto s = settings("sequence");
  const fs::path folder = s.output_folder;
  fs::create_directories(folder / "labels");
  std::ofstream(folder / "labels" / "000000.label") << "official";
  EXPECT_NE(errorOf(s).find("files that no run wrote"), std::string::npos);
  EXPECT_EQ(readWhole(folder / "labels" / "000000.label"), "official");

  s = settings("in_place");
  fs::create_directories(s.output_folder);
  s.rawlog = s.output_folder + "/static_scans.rawlog";
  fs::copy_file(recording(), s.rawlog);
  const std::string before = readWhole(s.rawlog);
  EXPECT_NE(errorOf(s).find("would be replaced"), std::string::npos);
  EXPECT_EQ(readWhole(s.rawlog), before);
}

TEST_F(SlamRunTrouble, WarnsWhereNothingMeasuresTheMotion)
{
  auto s = settings("unmeasured");
  s.labels = false;
  s.config.set("odometry.method=constant_velocity");
  s.config.set("refine.method=none");
  s.config.set("input.only_first_n=2");
  const auto warnings = runSlam(s).warnings;
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings.back().find("refine.method"), std::string::npos) << warnings.back();
}

/** With a limit that no scan meets. */
TEST_F(SlamRunTrouble, ARunThatFailedSaysSo)
{
  auto s = settings("failed");
  s.labels = false;
  s.config.set("refine.min_inlier_ratio=1");
  s.config.set("input.only_first_n=12");
  s.config.set("output.replay=false");
  const SlamRunReport report = runSlam(s);
  EXPECT_GT(report.unconverged, 6U);
  EXPECT_NE(report.failure.find("of 12 scans could not be registered"), std::string::npos)
      << report.failure;
  EXPECT_NE(report.failure.find("inlier ratio"), std::string::npos) << report.failure;
  EXPECT_EQ(report.verdict, "unusable");
  EXPECT_NE(readWhole(fs::path(s.output_folder) / "report.json").find("could not be registered"),
            std::string::npos);
}

TEST_F(SlamRunTrouble, EmptyScansAndBadPointsDoNotStopIt)
{
  auto s = settings("spoiled");
  s.rawlog = (folder_ / "spoiled.rawlog").string();
  writeRecording(s.rawlog, town(), scan_count, true);
  const auto report = runSlam(s);
  EXPECT_EQ(report.frames, static_cast<std::size_t>(scan_count));
  EXPECT_EQ(report.unconverged, 1U);
  EXPECT_LT(errorsOf(s.output_folder).end.percent, 3.0);
}

TEST_F(SlamRunTrouble, BadConfigIsNamedBeforeAnythingIsWritten)
{
  const auto errorWith = [](const std::string& assignment)
  {
    auto s = settings("never");
    s.config.set(assignment);
    return errorOf(s);
  };
  EXPECT_NE(errorWith("odometri.method=gicp").find("did you mean 'odometry'"), std::string::npos);
  EXPECT_NE(errorWith("odometry.methode=gicp").find("did you mean 'method'"), std::string::npos);
  EXPECT_NE(errorWith("odometry.method=gicpp").find("did you mean 'gicp'"), std::string::npos);
  EXPECT_NE(errorWith("refine.cell_size=-1").find("out of range"), std::string::npos);
  EXPECT_NE(errorWith("refine.cell_size=wide").find("not a number"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "never"));
}

TEST_F(SlamRunTrouble, AnOutputFolderThatCannotBeMadeIsNamed)
{
  auto s = settings("x");
  s.output_folder = "/proc/dyslam-out";
  EXPECT_NE(errorOf(s).find("/proc/dyslam-out"), std::string::npos);
  std::ofstream(folder_ / "file") << "x";
  s.output_folder = (folder_ / "file" / "below").string();
  EXPECT_NE(errorOf(s).find("output"), std::string::npos);
}
}  // namespace
}  // namespace dyslam
