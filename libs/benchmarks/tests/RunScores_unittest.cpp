// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/RunTables.h>
#include <dyslam/benchmarks/SplitTables.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** A trajectory straight ahead, 1 m per 0.1 s. \param scale factor on the distances */
Trajectory straight(double scale, int poses = 40)
{
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i)
  {
    trajectory.push_back(100 + 0.1 * i, poseFromYpr(scale * i, 0, 0, 0, 0, 0));
  }
  return trajectory;
}

class RunScoresOf : public ::testing::Test
{
 protected:
  /** The output folder of a run. */
  std::string writeRun(const std::string& name, const std::string& report) const
  {
    std::filesystem::create_directories(folder_.file(name));
    writeTum(folder_.file(name + "/trajectory_tum.txt"), straight(1.01));
    writeTum(folder_.file(name + "/odometry_tum.txt"), straight(1.02));
    if (!report.empty())
    {
      folder_.write(name + "/report.json", report);
    }
    return folder_.file(name);
  }
  RunScores scores(const std::string& run,
                   const std::string& truth = "",
                   const std::optional<double>& interpolate = {})
  {
    notes_.clear();
    TrajectoryMetricsOptions metrics;
    metrics.lengths = {10};
    return scoresOf(
        run, truth, metrics, [this](const std::string& note) { notes_.push_back(note); },
        interpolate);
  }

  TestFolder folder_;
  std::vector<std::string> notes_;
};
}  // namespace

TEST_F(RunScoresOf, ReferenceLabelsAndReportAreUsed)
{
  const std::string run = writeRun(
      "run",
      R"({"frames": 40, "ms_per_scan": 20, "stage_ms": {"odometry": 12.5}, "finished": true})");
  writeTum(folder_.file("run/reference_tum.txt"), straight(1));
  std::filesystem::create_directories(folder_.file("x.gt/labels"));
  std::filesystem::create_directories(folder_.file("run/labels"));
  writeLabels(folder_.file("x.gt/labels/000000.label"),
              {label_moving, label_moving, label_static, label_static});
  writeLabels(folder_.file("run/labels/000000.label"),
              {label_moving, label_static, label_static, label_static});
  RunScores one = scores(run, folder_.file("x.gt"));
  EXPECT_TRUE(notes_.empty()) << notes_.front();
  one.name = "run";
  ASSERT_TRUE(one.trajectory && one.odometry && one.labels);
  EXPECT_NEAR(one.trajectory->drift.overall.translation_percent, 1, 0.2);
  EXPECT_NEAR(one.odometry->drift.overall.translation_percent, 2, 0.4);
  EXPECT_DOUBLE_EQ(one.labels->evaluator.scores().recall().value(), 0.5);
  EXPECT_FALSE(one.consistency);
  EXPECT_FALSE(one.world);

  const Table table = runTable({one});
  EXPECT_EQ(table.rows(), 2U) << "final and odometry";
  EXPECT_TRUE(contains(table.toCsv(), "run,final,40,"));
  EXPECT_EQ(stageTable({one}).toCsv(), "stage [ms per scan],run\nodometry,12.5\n");
  EXPECT_TRUE(consistenciesOf({one}).empty());
  EXPECT_EQ(splitLines({one}), "");
  EXPECT_TRUE(contains(truthLines({one}), "run: ground truth: "));
  const auto json = nlohmann::json::parse(runJson({one}))["runs"][0];
  EXPECT_EQ(json["report"]["frames"], 40);
  EXPECT_DOUBLE_EQ(json["segmentation"]["recall"].get<double>(), 0.5);
}

TEST_F(RunScoresOf, GroundTruthOfAConvertedRecordingIsMovedWithItsRun)
{
  const std::string run =
      writeRun("run", R"({"frames": 40, "input": "/before/run/recording.rawlog"})");
  writeTum(folder_.file("run/reference_tum.txt"), straight(1));
  folder_.write("run/recording.rawlog", "");
  for (const std::string name : {"run/recording.gt/labels", "run/labels"})
  {
    std::filesystem::create_directories(folder_.file(name));
    writeLabels(folder_.file(name + "/000000.label"), {label_moving, label_static});
  }
  const RunScores one = scores(run);
  EXPECT_TRUE(notes_.empty()) << notes_.front();
  EXPECT_TRUE(one.labels);
}

TEST_F(RunScoresOf, GroundTruthWithOtherStampsIsInterpolated)
{
  const std::string run = writeRun("run", R"({"frames": 40, "finished": true})");
  Trajectory truth;
  for (const StampedPose& pose : straight(1))
  {
    truth.push_back(pose.stamp + 0.05, pose.pose);
  }
  std::filesystem::create_directories(folder_.file("x.gt"));
  writeTum(folder_.file("x.gt/poses_tum.txt"), truth);
  EXPECT_FALSE(scores(run, folder_.file("x.gt")).trajectory);
  EXPECT_TRUE(hasLine(notes_,
                      "0 of 40 poses match a time stamp of the ground truth, 2 are needed: "
                      "no errors computed; --interpolate 0.5 interpolates the ground truth"));
  const RunScores one = scores(run, folder_.file("x.gt"), 0.1);
  ASSERT_TRUE(one.trajectory && one.odometry);
  EXPECT_EQ(39U, one.trajectory->pairs);
  EXPECT_NEAR(one.trajectory->drift.overall.translation_percent, 1, 0.2);
  EXPECT_FALSE(scores(run, folder_.file("x.gt"), 0.02).trajectory);
  EXPECT_TRUE(hasLine(notes_, "within --interpolate 0.02 s before and after them, 2 are needed"));
}

TEST_F(RunScoresOf, WhatIsMissingIsNoted)
{
  const std::string run = writeRun("run", "");
  EXPECT_FALSE(scores(run).trajectory);
  ASSERT_EQ(notes_.size(), 2U);
  EXPECT_EQ(notes_[0], run + " has no report.json: the run did not finish");
  EXPECT_EQ(notes_[1], run +
                           " has no reference_tum.txt: its recording has no ground truth to "
                           "compare the trajectory with (dyslam-eval trajectory compares it with "
                           "a file of poses)");

  writeRun("labelled", R"({"frames": 40, "input": "x.rawlog"})");
  folder_.write("labelled/labels/000000.label", "");
  (void)scores(folder_.file("labelled"));
  ASSERT_EQ(notes_.size(), 2U);
  EXPECT_TRUE(contains(notes_[1], "labels not evaluated: no ground truth known (--truth)"))
      << notes_[1];
  std::filesystem::create_directories(folder_.file("x.gt"));
  (void)scores(folder_.file("labelled"), folder_.file("x.gt"));
  ASSERT_EQ(notes_.size(), 2U);
  EXPECT_TRUE(contains(notes_[1], "x.gt has no labels/")) << notes_[1];

  writeRun("run", R"({"frames": 40, "finished": false, "not_written": ["map.png: disk full"]})");
  folder_.write("run/resume.state", "");
  writeTum(folder_.file("run/reference_tum.txt"), straight(1, 3));
  EXPECT_TRUE(scores(run).trajectory);
  ASSERT_EQ(notes_.size(), 3U);
  EXPECT_EQ(notes_[0], folder_.file("run") + " lacks a file: map.png: disk full");
  EXPECT_TRUE(contains(notes_[1], "only 3 of 40 poses have one of 3 in ")) << notes_[1];
  EXPECT_EQ(notes_[2], run + ": unfinished: 40 scans; continue with: dyslam --resume -o " + run);
}

TEST_F(RunScoresOf, WarningsOfTheReportAreListed)
{
  RunScores lost = scores(writeRun(
      "lost", R"({"verdict": "unusable", "failure": "30 of 40 scans could not be registered",
                  "warnings": ["the local map was restarted once"]})"));
  lost.name = "lost";
  RunScores sound = scores(writeRun("sound", R"({"verdict": "usable", "warnings": []})"));
  sound.name = "sound";
  EXPECT_EQ(warningLines({lost, sound}),
            "lost: unusable: 30 of 40 scans could not be registered\n"
            "lost: warning: the local map was restarted once\n");
  EXPECT_EQ(warningLines({scores(writeRun("unfinished", ""))}), "");
}

TEST_F(RunScoresOf, EqualLinesAreOne)
{
  std::vector<RunScores> runs(3);
  const char* const names[] = {"00", "01", "02"};
  for (std::size_t i = 0; i < runs.size(); ++i)
  {
    runs[i].name = names[i];
    runs[i].trajectory.emplace();
    runs[i].truth = {PoseSource::given, "poses.txt"};
  }
  runs[1].report.warnings = {"one", "two"};
  runs[2].report.warnings = {"two"};
  EXPECT_EQ(truthLines(runs).rfind("00, 01, 02: ground truth: given poses (poses.txt)", 0), 0U)
      << truthLines(runs);
  EXPECT_EQ(warningLines(runs), "01: warning: one\n01, 02: warning: two\n");
}

TEST_F(RunScoresOf, EqualTrajectoriesAreOneRowAndRecordingsHaveAMean)
{
  const auto runOf = [](const std::string& name, double length, double ate)
  {
    RunScores run;
    run.name = name;
    run.report.frames = 40;
    run.trajectory.emplace();
    run.trajectory->length = length;
    run.trajectory->pairs = 40;
    run.true_poses = straight(length / 100);
    run.trajectory->absolute.translation.rmse = ate;
    run.trajectory->drift.overall.segments = 1;
    run.trajectory->drift.overall.translation_percent = ate;
    run.odometry = run.trajectory;
    return run;
  };
  std::vector<RunScores> runs{runOf("00", 100, 1), runOf("01", 200, 2)};
  const std::string same = runTable(runs).toCsv();
  EXPECT_TRUE(contains(same, "\n00,final = odometry,40,100,1,0,0,0,1,")) << same;
  EXPECT_TRUE(contains(same, "\nmean,final = odometry,80,300,1.5,0,0,0,1.5,")) << same;
  EXPECT_EQ(runTable(runs).rows(), 3U);
  runs[1].odometry->absolute.translation.rmse = 4;  // before a loop
  const std::string optimised = runTable(runs).toCsv();
  EXPECT_TRUE(contains(optimised, "\n01,final,40,200,")) << optimised;
  EXPECT_TRUE(contains(optimised, "\n01,odometry,,200,")) << optimised;
  EXPECT_TRUE(contains(optimised, "\nmean,final,80,300,1.5,0,0,0,1.5,")) << optimised;
  EXPECT_TRUE(contains(optimised, "\nmean,odometry,,300,1.5,0,0,0,2.5,")) << optimised;
  EXPECT_EQ(runTable({runs[0], runOf("gicp", 100, 3)}).rows(), 2U) << "one recording: no mean";
  EXPECT_EQ(runTable({runs[0]}).rows(), 1U);
}

TEST_F(RunScoresOf, RunsOfPartsOfOneRecordingHaveNoMean)
{
  const auto rowsWith = [&](const Trajectory& reference)
  {
    std::vector<RunScores> runs;
    for (const std::string name : {"a", "b"})
    {
      const std::string run = writeRun(name, R"({"frames": 40})");
      writeTum(run + "/reference_tum.txt", name == "a" ? straight(1) : reference);
      runs.push_back(scores(run));
      runs.back().name = name;
    }
    return runTable(runs).toCsv();
  };
  EXPECT_FALSE(contains(rowsWith(straight(1)), "\nmean,"));
  EXPECT_FALSE(contains(rowsWith(straight(1, 39)), "\nmean,")) << "a scan less";
  EXPECT_FALSE(contains(rowsWith(straight(1, 20)), "\nmean,"));
  EXPECT_TRUE(contains(rowsWith(straight(1.5)), "\nmean,")) << "another drive at the same times";
}

TEST_F(RunScoresOf, LabelsAreStatedWithTheirKindAndTheLabelledShare)
{
  const std::string run = writeRun("run", R"({"frames": 40})");
  const std::string truth = folder_.file("x.gt");
  std::filesystem::create_directories(truth + "/labels");
  std::filesystem::create_directories(folder_.file("run/labels"));
  const auto linesWith = [&](const std::string& ini, const std::vector<Label>& reference)
  {
    folder_.write("run/effective.ini", ini);
    writeLabels(truth + "/labels/000000.label", reference);
    writeLabels(folder_.file("run/labels/000000.label"),
                std::vector<Label>(reference.size(), label_static));
    RunScores one = scores(run, truth);
    one.name = "run";
    return labelLines({one}) + (contains(runJson({one}), "\"hindsight\": true") ? "in JSON" : "");
  };
  std::vector<Label> reference(100, label_static);
  EXPECT_EQ(linesWith("[labels]\nhindsight = true\n", reference),
            "run: labels: with hindsight (offline, non-causal)\nin JSON");
  EXPECT_EQ(linesWith("[labels]\nhindsight = false\n", reference), "run: labels: causal\n");
  EXPECT_EQ(linesWith("[map]\nvoxel_size = 0.2\n", reference), "") << "not known";
  EXPECT_EQ(notes_.size(), 1U) << "no true poses";
  EXPECT_EQ(linesWith("[labels\n", reference), "");
  ASSERT_EQ(notes_.size(), 2U);
  EXPECT_TRUE(contains(notes_[1], "with hindsight is not known: ")) << notes_[1];

  std::fill_n(reference.begin(), 5, 0);  // not labelled
  EXPECT_EQ(linesWith("[labels]\nhindsight = false\n", reference), "run: labels: causal\n");
  std::fill_n(reference.begin(), 84, 0);
  EXPECT_EQ(linesWith("[labels]\nhindsight = false\n", reference),
            "run: labels: causal\n"
            "run: labels: 16 % of the points are labelled in the ground truth; IoU, precision and "
            "recall are of these\n");
}

TEST_F(RunScoresOf, OtherFoldersAreRefused)
{
  std::filesystem::create_directories(folder_.file("empty"));
  EXPECT_EQ(whyNoRun(writeRun("run", "{}")), "");
  EXPECT_EQ(whyNoRun(folder_.file("none")), "is not a folder");
  EXPECT_TRUE(contains(whyNoRun(folder_.file("empty")), "has no trajectory_tum.txt"));
  EXPECT_EQ(whyNoRun(folder_.path()), "is a folder of runs, not that of one; give those in it");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)scores(folder_.file("empty")); }),
                       "empty: has no trajectory_tum.txt"));
  folder_.write("run/report.json", "[]");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)scores(folder_.file("run")); }),
                       "report.json: is not the JSON report of a run"));
}

TEST_F(RunScoresOf, ASplitHasItsDrives)
{
  const SplitColumns columns{"dyslam", {{"DySLAM", "dyslam"}, {"GICP", "gicp"}}, {}};
  const auto drives = [&]
  {
    return readDrives(folder_.file("runs"), columns, {},
                      [this](const std::string& note) { notes_.push_back(note); });
  };
  EXPECT_TRUE(contains(messageOfError<UserError>(drives), "runs: is not a folder"));
  std::filesystem::create_directories(folder_.file("runs/b"));
  EXPECT_TRUE(contains(messageOfError<UserError>(drives), "has no DRIVE/METHOD"));
  writeRun("runs/a/dyslam", R"({"frames": 40, "ms_per_scan": 10})");
  const std::vector<DriveScores> found = drives().drives;
  ASSERT_EQ(found.size(), 1U) << "b has no run";
  EXPECT_EQ(found[0].name, "a");
  EXPECT_EQ(found[0].runs.count("dyslam"), 1U);
  const std::string times = timeTable(found, columns.odometry).toCsv();
  EXPECT_TRUE(contains(times, "DySLAM,")) << times;
  EXPECT_FALSE(contains(times, "GICP")) << "no drive has that run";

  writeRun("runs/b/dyslam", R"({"frames": 40, "ms_per_scan": 0.0, "finished": false})");
  EXPECT_EQ(timeTable(drives().drives, columns.odometry).toCsv(), times) << "b did not finish";
}

TEST_F(RunScoresOf, TheRunsOfABatchAreInAFolderOfTheMethod)
{
  for (const std::string run : {"ours/00", "ours/01", "gicp/00", "gicp/01"})
  {
    writeRun(run, R"({"frames": 40, "ms_per_scan": 10})");
    writeTum(folder_.file(run + "/reference_tum.txt"), straight(1));
  }
  std::filesystem::create_directories(folder_.file("ours/slurm"));
  const auto drives = [&](const std::string& root, const SplitColumns& columns)
  {
    TrajectoryMetricsOptions metrics;
    metrics.lengths = {10};
    return readDrives(root, columns, metrics, [](const std::string&) {}).drives;
  };
  const SplitColumns names{"ours", {{"Ours", "ours"}, {"GICP", "gicp"}}, {}};
  const std::vector<DriveScores> found = drives(folder_.path(), names);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "00");
  EXPECT_EQ(found[1].runs.size(), 2U);
  const std::vector<RunColumn> paths{{"Ours", folder_.file("ours")},
                                     {"GICP", folder_.file("gicp")}};
  const std::vector<DriveScores> named = drives("", {paths[0].folder, paths, paths});
  ASSERT_EQ(named.size(), 2U);
  const std::string drift = driftTable(named, paths).toCsv();
  EXPECT_EQ(drift.rfind("drive,Ours t_rel,Ours r_rel,GICP t_rel,GICP r_rel\n00,", 0), 0U) << drift;
  EXPECT_TRUE(contains(drift, "\nmean of 2,"));
  EXPECT_EQ(drift, driftTable(found, names.odometry).toCsv());
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] {
                             (void)drives("", {folder_.file("none"), {}, {}});
                           }),
                       "none: is not a folder"));
  std::filesystem::create_directories(folder_.file("empty"));
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] {
                             (void)drives("", {folder_.file("empty"), {}, {}});
                           }),
                       "empty: has no DRIVE with results of dyslam"));
}

TEST_F(RunScoresOf, AMethodWithoutTruePosesTakesNoMeansFromTheOthers)
{
  for (const std::string run : {"ours/00", "ours/01", "gicp/00", "gicp/01"})
  {
    const std::string folder = writeRun(run, R"({"frames": 40, "ms_per_scan": 10})");
    if (run.rfind("ours", 0) == 0)
    {
      writeTum(folder + "/reference_tum.txt", straight(1));
    }
  }
  const std::vector<RunColumn> columns{{"A|B", folder_.file("ours")},
                                       {"GICP", folder_.file("gicp")}};
  const auto drives = [&]
  {
    TrajectoryMetricsOptions metrics;
    metrics.lengths = {10};
    return readDrives("", {columns[0].folder, columns, columns}, metrics, [](const std::string&) {})
        .drives;
  };
  const std::string without = driftTable(drives(), columns).toMarkdown();
  EXPECT_TRUE(contains(without, "| drive | A\\|B t_rel | A\\|B r_rel |\n")) << without;
  EXPECT_TRUE(contains(without, "| mean of 2 | 2.20 | 0.00 |")) << without;
  EXPECT_EQ(columnsWithoutDrift(drives(), columns), std::vector<std::string>{"GICP"});
  writeTum(folder_.file("gicp/01/reference_tum.txt"), straight(1));
  const std::string with = driftTable(drives(), columns).toMarkdown();
  EXPECT_TRUE(contains(with, "| mean of 1 | 2.20 | 0.00 | 2.20 | 0.00 |")) << with;
  EXPECT_TRUE(columnsWithoutDrift(drives(), columns).empty());
}

TEST_F(RunScoresOf, TablesWithoutContentAreLeftOut)
{
  std::vector<DriveScores> drives(1);
  drives[0].name = "04";
  RunScores& run = drives[0].runs["ours"];
  run.report.frames = 270;
  run.report.ms_per_scan = 10;
  run.trajectory.emplace();
  run.trajectory->drift.overall.segments = 1;
  run.trajectory->drift.overall.translation_percent = 0.5;
  run.odometry = run.trajectory;
  const SplitColumns columns{"ours", {{"Ours", "ours"}}, {{"Ours", "ours"}}};
  const std::string text = splitMarkdown(drives, columns, {100});
  EXPECT_TRUE(contains(text, "**Odometry**")) << text;
  EXPECT_TRUE(contains(text, "**Time**"));
  for (const char* absent : {"Split", "Moving points", "Final trajectory", "paper"})
  {
    EXPECT_FALSE(contains(text, absent)) << text;
  }
  EXPECT_FALSE(areKittiOdometry(drives)) << "another number of scans";
  run.report.frames = 271;
  EXPECT_TRUE(areKittiOdometry(drives));
  const std::string kitti = splitMarkdown(drives, columns, {100});
  EXPECT_TRUE(contains(kitti, "paper: LOAM t_rel")) << kitti;
  EXPECT_TRUE(contains(kitti, "| 04 | 0.50 | **0.00** | 1.45 | 0.50 | **0.45** | 0.56 |")) << kitti;
  EXPECT_FALSE(contains(kitti, "the paper: LOAM")) << "times of another machine";
  run.trajectory->absolute.translation.rmse = 1;
  EXPECT_TRUE(contains(splitMarkdown(drives, columns, {100}), "**Final trajectory**"));
}

TEST_F(RunScoresOf, ASplitIsReadWithoutTheRunsThatCannotBe)
{
  const SplitColumns columns{"dyslam", {{"DySLAM", "dyslam"}, {"GICP", "gicp"}}, {}};
  const auto drives = [&]
  {
    notes_.clear();
    return readDrives(folder_.file("runs"), columns, {},
                      [this](const std::string& note) { notes_.push_back(note); });
  };
  writeRun("runs/a/dyslam", "[]");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)drives(); }),
                       "runs: has no run that can be read"));
  writeRun("runs/a/gicp", R"({"frames": 40})");
  writeRun("runs/b/dyslam", R"({"frames": 40})");
  const SplitRuns found = drives();
  const std::string damaged = folder_.file("runs/a/dyslam");
  EXPECT_EQ(found.failed, std::vector<std::string>{damaged}) << "once, though in two columns";
  ASSERT_EQ(found.drives.size(), 2U);
  EXPECT_EQ(found.drives[0].runs.count("dyslam"), 0U);
  EXPECT_EQ(found.drives[0].runs.count("gicp"), 1U);
  EXPECT_EQ(found.drives[1].runs.count("dyslam"), 1U);
  const std::string start = damaged + ": not evaluated: ";
  EXPECT_EQ(std::count_if(notes_.begin(), notes_.end(),
                          [&](const std::string& note) { return note.rfind(start, 0) == 0; }),
            1);
}

TEST_F(RunScoresOf, AllPointsAreOfDrivesWithLabelsOfEveryMethod)
{
  const auto withLabels = [](const std::vector<Label>& estimate)
  {
    RunScores run;
    run.labels.emplace();
    run.labels->evaluator.add({label_moving, label_moving, label_static}, estimate);
    return run;
  };
  std::vector<DriveScores> drives(2);
  drives[0].name = "both";
  drives[0].runs["causal"] = withLabels({label_moving, label_static, label_static});
  drives[0].runs["dyslam"] = withLabels({label_moving, label_moving, label_static});
  drives[1].name = "one";
  drives[1].runs["causal"] = withLabels({label_moving, label_static, label_static});
  drives[1].runs["dyslam"] = RunScores();  // without labels
  const std::string table =
      movingTable(drives, {{"causal", "causal"}, {"hindsight", "dyslam"}}).toCsv();
  EXPECT_TRUE(contains(table, "\nmean of 1,0.5,1,0.5,1,1,1\n")) << table;
  EXPECT_TRUE(contains(table, "\nall points,0.5,1,0.5,1,1,1\n")) << table;
  drives[0].runs["causal"] = withLabels({label_static, label_static, label_moving});
  const std::string other =
      movingTable(drives, {{"causal", "causal"}, {"hindsight", "dyslam"}}).toCsv();
  EXPECT_TRUE(contains(other, "\nall points,0,0,0,1,1,1\n")) << "not those of one, too\n" << other;
}
}  // namespace dyslam
