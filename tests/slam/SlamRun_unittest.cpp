// SPDX-License-Identifier: BSD-3-Clause
// Whole runs on a small simulated recording: from the rawlog to every file of the output folder.
#include <dyslam/core/Labels.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/RawlogSource.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "SlamRunTest.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
using SlamRun = SlamRunTest;

TEST_F(SlamRun, LeavesEveryFileAndASmallError)
{
  auto s = settings("whole");
  const SlamRunReport report = runSlam(s);
  EXPECT_EQ(report.frames, static_cast<std::size_t>(scan_count));
  EXPECT_EQ(report.unconverged, 0U);
  EXPECT_GT(report.map_points, 1000U);
  EXPECT_TRUE(report.has_reference);
  for (const auto& name :
       {"effective.ini",     "odometry_tum.txt", "trajectory_tum.txt",  "trajectory_kitti.txt",
        "reference_tum.txt", "scans.csv",        "motions.csv",         "tracks.csv",
        "tracks.txt",        "graph.graph",      "graph.g2o",           "factor_graph.txt",
        "map_static.pcd",    "map_static.ply",   "keyframes.simplemap", "map.3Dscene",
        "replay.rawlog",     "trajectory.png",   "report.html",         "map.png",
        "report.json"})
  {
    EXPECT_GT(readWhole(fs::path(s.output_folder) / name).size(), 0U) << name;
  }
  const auto errors = errorsOf(s.output_folder);
  EXPECT_EQ(errors.pairs, static_cast<std::size_t>(scan_count));
  EXPECT_LT(errors.end.percent, 2.0);
  EXPECT_LT(errors.relative.translation.rmse, 0.05);

  const auto pointsOf = [&](int frame)
  {
    RawlogSourceOptions options;
    options.skip_first_n = frame;
    RawlogSource source(s.rawlog, options);
    return source.next()->scan.size();
  };
  EXPECT_EQ(readLabels(s.output_folder + "/labels/000000.label").size(), pointsOf(0));
  EXPECT_EQ(readLabels(s.output_folder + "/labels/000039.label").size(), pointsOf(39));
}

TEST_F(SlamRun, WhatFollowsTheLastScanIsAnnounced)
{
  SlamRunSettings s = settings("announced");
  s.config.set("input.only_first_n=3");
  std::vector<std::string> told;
  std::size_t frames = 0;
  s.after_scans = [&](const std::string& work)
  {
    EXPECT_EQ(frames, 3U);
    told.push_back(work);
  };
  (void)runSlam(s, [&](double, std::size_t count) { frames = count; });
  EXPECT_EQ(told,
            (std::vector<std::string>{"completing graph, labels and map", "writing the results"}));
}

TEST_F(SlamRun, SameBytesForAnyThreadCountAndMemory)
{
  auto one = settings("one");
  one.config.set("pipeline.threads=1");
  (void)runSlam(one);
  auto three = settings("three");
  three.config.set("pipeline.threads=3");
  (void)runSlam(three);
  auto little = settings("little");
  little.config.set("memory.limit=1");
  (void)runSlam(little);
  const auto report = readWhole(little.output_folder + "/report.json");
  EXPECT_EQ(report.find("\"temporary_file\": 0.0"), std::string::npos) << report;
  EXPECT_NE(readWhole(one.output_folder + "/report.json").find("\"temporary_file\": 0.0"),
            std::string::npos);
  const auto expected = filesOf(one.output_folder);
  for (const auto* folder : {&three.output_folder, &little.output_folder})
  {
    const auto files = filesOf(*folder);
    ASSERT_EQ(files.size(), expected.size());
    for (const auto& [name, content] : expected)
    {
      if (name != "trajectory.png")  // its title contains the folder's name
      {
        EXPECT_TRUE(files.at(name) == content) << *folder << "/" << name << " differs";
      }
    }
  }
}

TEST_F(SlamRun, EffectiveIniGivesTheSameRun)
{
  auto first = settings("first");
  first.config.set("refine.cell_size=0.7");
  first.config.set("input.only_first_n=12");
  (void)runSlam(first);
  auto second = settings("second");
  second.config = Config::fromFile(first.output_folder + "/effective.ini");
  (void)runSlam(second);
  EXPECT_EQ(readWhole(first.output_folder + "/trajectory_tum.txt"),
            readWhole(second.output_folder + "/trajectory_tum.txt"));
  EXPECT_EQ(readWhole(first.output_folder + "/effective.ini"),
            readWhole(second.output_folder + "/effective.ini"));
}

TEST_F(SlamRun, TheTimeOfAFirstPassCounts)
{
  auto s = settings("second_pass");
  s.labels = false;
  s.config.set("input.only_first_n=3");
  s.first_pass_time = 1000;
  const SlamRunReport report = runSlam(s);
  EXPECT_GT(report.run_time, 1000);
  EXPECT_EQ(report.first_pass_time, 1000);
  EXPECT_LT(report.realtimeFactor(), 0.001);
}

TEST_F(SlamRun, AKnownStartSpeedIsTheFirstGuess)
{
  auto s = settings("start_speed");
  s.labels = false;
  s.config.set("odometry.method=constant_velocity");
  s.config.set("odometry.start_speed=12");
  s.config.set("refine.method=none");
  s.config.set("input.only_first_n=2");
  s.config.set("output.replay=false");
  ASSERT_EQ(runSlam(s).frames, 2U);
  EXPECT_NEAR(firstStep(s, "odometry_tum.txt").translation().x(), 1.2, 0.01);
}

TEST_F(SlamRun, TheSegmentersMotionIsTheFirstGuess)
{
  auto s = settings("segmenter_start");
  s.labels = false;
  s.config.set("odometry.method=constant_velocity");
  s.config.set("dyseg.method=network");
  s.config.set("refine.method=none");
  s.config.set("input.skip_first_n=10");
  s.config.set("input.only_first_n=2");
  s.config.set("output.replay=false");
  ASSERT_EQ(runSlam(s).frames, 2U);
  const double truth = firstStep(s, "reference_tum.txt").translation().norm();
  ASSERT_GT(truth, 0.3) << "the ego drives";
  EXPECT_NEAR(firstStep(s, "odometry_tum.txt").translation().norm(), truth, 0.5 * truth);
}

/** Highways on which registration alone follows the traffic, fast and in a jam. */
TEST_F(SlamRun, FindsTheWorldAmongTrafficThatDrivesAlong)
{
  struct Traffic
  {
    double density;
    std::vector<int> seeds;
    double within;      // largest error of the forward ratio of a success
    std::size_t least;  // least number of worlds with success
  };
  for (const auto& [traffic, seeds, within, least] :
       {Traffic{0.6, {302}, 0.05, 1}, Traffic{1.0, {306, 305, 304, 303}, 0.15, 3}})
  {
    std::size_t found = 0;
    for (const int seed : seeds)
    {
      sim::SimulatorOptions options;
      options.world = sim::WorldKind::highway;
      options.traffic = traffic;
      options.seed = static_cast<unsigned>(seed);
      options.columns = 1024;
      auto s = settings("traffic");
      s.rawlog = (folder_ / "highway.rawlog").string();
      writeRecording(s.rawlog, options, 16, false);
      s.config = Config::fromFile(std::string(DYSLAM_SOURCE_DIR) +
                                  "/share/dyslam/config_files/kitti64.ini");
      s.labels = false;
      s.config.set("pipeline.mapping=false");
      s.config.set("pipeline.tracking=false");
      s.config.set("output.replay=false");
      const auto forwardRatio = [&](const std::string& segmenter)
      {
        s.config.set("dyseg.method=" + segmenter);
        EXPECT_EQ(runSlam(s).frames, 16U);
        const auto errors = errorsOf(s.output_folder);
        EXPECT_GT(errors.length, 2);
        return errors.forward_ratio.value_or(0);
      };
      if (seed == seeds.front())
      {
        EXPECT_LT(forwardRatio("none"), 0.7) << "traffic " << traffic;
      }
      found += std::abs(forwardRatio("network") - 1) < within ? 1 : 0;
    }
    EXPECT_GE(found, least) << "traffic " << traffic;
  }
}

TEST_F(SlamRun, StaticScansAreTheScansWithoutWhatMoves)
{
  auto s = settings("static_scans");
  s.static_scans = true;
  s.config.set("input.only_first_n=15");
  s.config.set("output.replay=false");
  ASSERT_EQ(runSlam(s).frames, 15U);
  const fs::path folder(s.output_folder);
  RawlogSource recorded(recording());
  RawlogSource cleaned((folder / "static_scans.rawlog").string());
  std::size_t moving = 0;
  for (int i = 0; i < 15; ++i)
  {
    char name[16];
    std::snprintf(name, sizeof name, "%06d", i);
    const auto labels = readLabels((folder / "labels" / (std::string(name) + ".label")).string());
    const auto all = recorded.next();
    const auto kept = cleaned.next();
    ASSERT_TRUE(all && kept);
    const auto bin = readBin((folder / "static_scans" / (std::string(name) + ".bin")).string());
    std::vector<Eigen::Vector3f> expected;
    for (std::size_t k = 0; k < labels.size(); ++k)
    {
      if (semanticOf(labels[k]) < semanticOf(label_moving))
      {
        expected.push_back(all->scan.points[k]);
      }
    }
    moving += labels.size() - expected.size();
    EXPECT_EQ(bin.points, expected) << i;
    EXPECT_EQ(kept->scan.points, expected) << i;
    EXPECT_EQ(kept->scan.ring.size(), expected.size()) << i;
    EXPECT_TRUE(kept->T_world_vehicle_truth.has_value()) << i;
  }
  EXPECT_GT(moving, 0U) << "the town has traffic";
}

TEST_F(SlamRun, ProbabilitiesAreThoseThatTheLabelsWereDecidedBy)
{
  for (const bool hindsight : {true, false})
  {
    SCOPED_TRACE(hindsight ? "hindsight" : "causal");
    auto s = settings(std::string("probabilities_") + (hindsight ? "hindsight" : "causal"));
    s.probabilities = true;
    s.config.set("input.only_first_n=15");
    s.config.set("output.replay=false");
    s.config.set(std::string("labels.hindsight=") + (hindsight ? "true" : "false"));
    ASSERT_EQ(runSlam(s).frames, 15U);
    const fs::path folder(s.output_folder);
    std::size_t between = 0;
    for (int i = 0; i < 15; ++i)
    {
      char name[16];
      std::snprintf(name, sizeof name, "%06d", i);
      const auto labels = readLabels((folder / "labels" / (std::string(name) + ".label")).string());
      const auto bytes =
          readWhole((folder / "probabilities" / (std::string(name) + ".bin")).string());
      ASSERT_EQ(bytes.size(), labels.size() * sizeof(float));
      std::vector<float> p(labels.size());
      std::memcpy(p.data(), bytes.data(), bytes.size());
      for (std::size_t k = 0; k < labels.size(); ++k)
      {
        ASSERT_EQ(std::isnan(p[k]), labels[k] == 0) << k;
        if (labels[k] != 0)
        {
          ASSERT_TRUE(p[k] >= 0 && p[k] <= 1) << p[k];
          ASSERT_EQ(p[k] > 0.5F, isMovingLabel(labels[k])) << k << ", " << p[k];
          between += p[k] > 0.05F && p[k] < 0.95F ? 1 : 0;
        }
      }
    }
    EXPECT_GT(between, 0U) << "more than the decision";
  }
}

TEST_F(SlamRun, EveryOdometryMethodRuns)
{
  for (const auto* method : {"constant_velocity", "icp_po2po", "icp_po2pl", "gicp", "loam"})
  {
    auto s = settings(std::string("method_") + method);
    s.labels = false;
    s.config.set(std::string("odometry.method=") + method);
    s.config.set("input.only_first_n=15");
    s.config.set("output.replay=false");
    EXPECT_EQ(runSlam(s).frames, 15U) << method;
    EXPECT_LT(errorsOf(s.output_folder).end.percent, 5.0) << method;
  }
}
}  // namespace
}  // namespace dyslam
