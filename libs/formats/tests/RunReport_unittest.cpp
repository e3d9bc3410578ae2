// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/RunReport.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** A report with a value in every field. */
RunReport wholeReport()
{
  RunReport report;
  report.input = "/data/a \"b\".rawlog";
  report.sensor = "64 rings";
  report.ground_truth = PoseOrigin{PoseSource::gnss_ins, "oxts"};
  report.method = "residual + point_to_plane";
  report.finished = false;
  report.ended_early = "stopped on request after 59 scans";
  report.frames = 59;
  report.unconverged = 1;
  report.odometry_failed = 2;
  report.keyframes = 12;
  report.loops = 3;
  report.loops_left_out = 4;
  report.gnss = GnssFit{20, 0.25, 0.5, true};
  report.gravity.emplace();
  report.gravity->directions = 7;
  report.gravity->rmse = 0.25 * M_PI / 180;
  report.gravity->tilt = 1.5 * M_PI / 180;
  report.gravity->tilt_sigma = 0.125 * M_PI / 180;
  report.gravity->up_map = {0.6, 0, 0.8};
  report.gravity->bias = {0.01, -0.02, 0.03};
  report.gravity->levelled = true;
  report.prior_map.emplace();
  report.prior_map->localised = true;
  report.prior_map->path_length = 8.5;
  report.prior_map->tried = 11;
  report.prior_map->registered = 10;
  report.prior_map->found_again = 1;
  report.prior_map->rmse = 0.0625;
  report.tracks = 5;
  report.map_points = 123456;
  report.path_length = 100.0 / 3;
  report.ms_per_scan = 40.25;
  report.stage_ms = {{"dyseg", 3.5}, {"odometry", 12.25}};
  report.wait_ms = {{"reading", 0.5}};
  report.memory_mb = {{"largest", 512.26}, {"map", 3}};
  report.recording_time = 5.9;
  report.run_time = 2.95;
  report.realtime_factor = 2;
  report.verdict = "doubtful";
  report.failure = "none, in truth";
  report.warnings = {"the local map was restarted once"};
  report.not_written = {"map.png: disk full"};
  report.files = {"trajectory_tum.txt", "report.json"};
  return report;
}

std::string messageFor(const std::string& text)
{
  return messageOfError<UserError>([&] { (void)parseRunReport(text, "run/report.json"); });
}
}  // namespace

TEST(RunReport, TheTextHasTheKeysInTheirOrder)
{
  EXPECT_EQ(runReportText(wholeReport()), R"({
  "input": "/data/a \"b\".rawlog",
  "sensor": "64 rings",
  "ground_truth": {
    "source": "gnss_ins",
    "name": "oxts"
  },
  "method": "residual + point_to_plane",
  "finished": false,
  "ended_early": "stopped on request after 59 scans",
  "frames": 59,
  "unconverged": 1,
  "odometry_failed": 2,
  "keyframes": 12,
  "loops": 3,
  "loops_left_out": 4,
  "gnss": {
    "positions": 20,
    "horizontal_rmse_m": 0.25,
    "vertical_rmse_m": 0.5,
    "fused": true
  },
  "gravity": {
    "directions": 7,
    "rmse_deg": 0.25,
    "map_tilt_deg": 1.5,
    "map_tilt_sigma_deg": 0.125,
    "up_map": [
      0.6,
      0.0,
      0.8
    ],
    "accelerometer_bias_mps2": [
      0.01,
      -0.02,
      0.03
    ],
    "fused": false,
    "levelled": true
  },
  "prior_map": {
    "localised": true,
    "path_to_localisation_m": 8.5,
    "keyframes": 11,
    "registered": 10,
    "found_again": 1,
    "rmse_m": 0.0625
  },
  "tracks": 5,
  "map_points": 123456,
  "path_length_m": 33.3333333,
  "ms_per_scan": 40.25,
  "stage_ms": {
    "dyseg": 3.5,
    "odometry": 12.25
  },
  "wait_ms": {
    "reading": 0.5
  },
  "memory_mb": {
    "largest": 512.3,
    "map": 3.0
  },
  "recording_time_s": 5.9,
  "run_time_s": 2.95,
  "realtime_factor": 2.0,
  "verdict": "doubtful",
  "failure": "none, in truth",
  "warnings": [
    "the local map was restarted once"
  ],
  "not_written": [
    "map.png: disk full"
  ],
  "files": [
    "trajectory_tum.txt",
    "report.json"
  ]
}
)");
}

TEST(RunReport, IsReadAsItWasWritten)
{
  const std::string text = runReportText(wholeReport());
  const RunReport read = parseRunReport(text, "run/report.json");
  EXPECT_EQ(runReportText(read), text);
  EXPECT_EQ(read.input, "/data/a \"b\".rawlog");
  EXPECT_EQ(read.frames, 59U);
  EXPECT_FALSE(read.finished);
  ASSERT_TRUE(read.ground_truth && read.gnss && read.gravity && read.prior_map);
  EXPECT_EQ(read.ground_truth->source, PoseSource::gnss_ins);
  EXPECT_EQ(read.gnss->vertical_rmse, 0.5);
  EXPECT_NEAR(read.gravity->tilt, 1.5 * M_PI / 180, 1e-12) << "rad";
  EXPECT_NEAR(read.gravity->up_map.z(), 0.8, 1e-12);
  EXPECT_EQ(read.prior_map->registered, 10U);
  EXPECT_EQ(read.stage_ms.at("odometry"), 12.25);
  EXPECT_EQ(read.memory_mb.at("largest"), 512.3);
  EXPECT_EQ(read.warnings, wholeReport().warnings);

  RunReport lost = wholeReport();
  lost.prior_map = PriorMapFit();
  lost.prior_map->reason = "too few planes";
  const RunReport read_lost = parseRunReport(runReportText(lost), "run/report.json");
  EXPECT_EQ(runReportText(read_lost), runReportText(lost));
  EXPECT_EQ(read_lost.prior_map->reason, "too few planes");
  EXPECT_FALSE(read_lost.prior_map->localised);
}

TEST(RunReport, WhatIsNotStatedIsNothing)
{
  const RunReport empty = parseRunReport("{}", "run/report.json");
  EXPECT_TRUE(empty.finished) << "earlier versions wrote reports of whole runs only";
  EXPECT_EQ(empty.input, "");
  EXPECT_FALSE(empty.frames || empty.loops || empty.ms_per_scan || empty.path_length);
  EXPECT_FALSE(empty.ground_truth || empty.gnss || empty.gravity || empty.prior_map);
  EXPECT_TRUE(empty.stage_ms.empty() && empty.warnings.empty() && empty.files.empty());
  EXPECT_EQ(runReportText(empty).find("frames"), std::string::npos);

  RunReport unknown = wholeReport();
  unknown.path_length = std::numeric_limits<double>::quiet_NaN();
  unknown.stage_ms["dyseg"] = std::numeric_limits<double>::infinity();
  const RunReport read = parseRunReport(runReportText(unknown), "run/report.json");
  EXPECT_FALSE(read.path_length) << "no number is null in the file";
  EXPECT_EQ(read.stage_ms.count("dyseg"), 0U);
  EXPECT_EQ(read.stage_ms.count("odometry"), 1U);
}

TEST(RunReport, AFieldOfAnotherTypeIsNamed)
{
  const std::string of_dyslam = "; is it of dyslam?";
  for (const auto& [text, said] : {
           std::pair(R"({"input": 7})", "does not name the recording (\"input\")"),
           std::pair(R"({"frames": "many"})", "\"frames\" is not a whole number"),
           std::pair(R"({"frames": -1})", "\"frames\" is not a whole number"),
           std::pair(R"({"loops": 1.5})", "\"loops\" is not a whole number"),
           std::pair(R"({"ms_per_scan": [1]})", "\"ms_per_scan\" is not a number"),
           std::pair(R"({"finished": "no"})", "\"finished\" is not true or false"),
           std::pair(R"({"verdict": true})", "\"verdict\" is not a text"),
           std::pair(R"({"warnings": "one"})", "\"warnings\" is not a list of texts"),
           std::pair(R"({"files": ["map.png", 7]})", "\"files\" is not a list of texts"),
           std::pair(R"({"stage_ms": 3})", "\"stage_ms\" is not an object"),
           std::pair(R"({"stage_ms": {"dyseg": "x"}})", "\"stage_ms.dyseg\" is not a number"),
           std::pair(R"({"gnss": {"fused": 1}})", "\"gnss.fused\" is not true or false"),
           std::pair(R"({"gravity": {"map_tilt_deg": 1}})",
                     "gravity has no number \"map_tilt_sigma_deg\""),
           std::pair(R"({"gravity": {"map_tilt_deg": 1, "map_tilt_sigma_deg": 1, "directions": 1,
                                     "up_map": [0, 1]}})",
                     "\"gravity.up_map\" is not a list of three numbers"),
           std::pair(R"({"gravity": {"map_tilt_deg": 1, "map_tilt_sigma_deg": 1, "directions": 1,
                                     "up_map": [0, 0, 2]}})",
                     "gravity.up_map is no unit vector"),
       })
  {
    EXPECT_EQ(messageFor(text), "run/report.json: " + std::string(said) + of_dyslam) << text;
  }
  for (const std::string text : {"", "{", "[]", "{\"frames\": 3}}"})
  {
    EXPECT_EQ(messageFor(text), "run/report.json: is not the JSON report of a run; repeat the run")
        << text;
  }
  EXPECT_TRUE(contains(messageFor(std::string(1000, '[') + std::string(1000, ']')),
                       "run/report.json: is nested too deeply"));
}

TEST(RunReport, IsReadFromItsFolder)
{
  const TestFolder folder;
  EXPECT_FALSE(readRunReport(folder.path()));
  EXPECT_FALSE(runReportIfValid(folder.path()).frames);
  folder.write("report.json", "{\"frames\": 3}");
  const auto report = readRunReport(folder.path());
  ASSERT_TRUE(report);
  EXPECT_EQ(report->frames, 3U);
  EXPECT_EQ(runReportIfValid(folder.path()).frames, 3U);
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)recordingOf(*report, "run"); }),
                       "run/report.json: does not name the recording"));
  folder.write("report.json", "{\"frames\": 3, \"loops\": {}}");
  EXPECT_THROW((void)readRunReport(folder.path()), UserError);
  EXPECT_FALSE(runReportIfValid(folder.path()).frames) << "nothing of a damaged report";
}

TEST(RunReport, AMovedRecordingReplacesOnlyItsPath)
{
  const TestFolder folder;
  const std::string rest = ",\n \"of a later version\": [1, 2],   \"sensor\": \"s\"}";
  folder.write("report.json", "{  \"input\": \"/a/\\\"x\\\".rawlog\"" + rest);
  replaceInput(folder.path(), "/b/y\\z.rawlog");
  EXPECT_EQ(folder.read("report.json"), "{  \"input\": \"/b/y\\\\z.rawlog\"" + rest);
  EXPECT_EQ(readRunReport(folder.path())->input, "/b/y\\z.rawlog");
  folder.write("report.json", "[");
  EXPECT_THROW(replaceInput(folder.path(), "/b"), UserError);
}
}  // namespace dyslam
