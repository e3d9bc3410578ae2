// SPDX-License-Identifier: BSD-3-Clause
// Whole runs on a small simulated recording: from the rawlog to every file of the output folder.
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/eval/TrajectoryMetrics.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/run/SlamRun.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <tuple>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr int scan_count = 40;

/** Content of every file of a run by name, without files that hold clock times. */
std::map<std::string, std::string> filesOf(const fs::path& folder)
{
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
  {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_regular_file() && name != "report.json" && name != "effective.ini")
    {
      const std::string content = readWhole(entry.path());
      // Before the scans, the page has title, settings and times.
      files[name] = name == "report.html" ? content.substr(content.find("\"scans\":")) : content;
    }
  }
  return files;
}

class SlamRun : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ = fs::temp_directory_path() / ("dyslam_slam_run_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    writeRecording(recording(), town(), scan_count, false);
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string recording() { return (folder_ / "town.rawlog").string(); }

  static sim::SimulatorOptions town()
  {
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 900;
    options.traffic = 0.5;
    options.seed = 11;
    return options;
  }

  /** Writes a recording. \param spoiled adds an empty scan and invalid points among the good ones
   */
  static void writeRecording(const std::string& path,
                             const sim::SimulatorOptions& options,
                             int scans,
                             bool spoiled)
  {
    sim::Simulator simulator(options, 1);
    RawlogWriter writer(path);
    for (int i = 0; i < scans; ++i)
    {
      auto simulated = simulator.next();
      Scan& scan = simulated.scan;
      if (spoiled && i == 20)
      {
        scan.points.clear();
        scan.intensity.clear();
        scan.time.clear();
        scan.ring.clear();
      }
      else if (spoiled && i > 5)
      {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        scan.points.at(100) = Eigen::Vector3f(nan, 0, 0);
        scan.points.at(101) = Eigen::Vector3f(0, std::numeric_limits<float>::infinity(), 0);
        scan.points.at(102).setZero();
      }
      writer.write(scan, simulated.T_map_vehicle);
    }
    writer.close();
  }

  static SlamRunSettings settings(const std::string& output)
  {
    SlamRunSettings s;
    s.rawlog = recording();
    s.output_folder = (folder_ / output).string();
    s.config =
        Config::fromFile(std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/vlp16.ini");
    s.labels = true;
    return s;
  }

  /** Motion between the two poses of a run of two scans. */
  static Pose firstStep(const SlamRunSettings& s, const char* file)
  {
    const Trajectory poses = readTum((fs::path(s.output_folder) / file).string());
    EXPECT_EQ(poses.size(), 2U) << file;
    return poses.size() == 2 ? poses[0].pose.inverse() * poses[1].pose : Pose::Identity();
  }

  static TrajectoryReport errorsOf(const fs::path& run)
  {
    const auto pairs = associateByTime(readTum((run / "reference_tum.txt").string()),
                                       readTum((run / "trajectory_tum.txt").string()), 1e-3);
    return evaluateTrajectory("run", pairs);
  }

  static std::string errorOf(const SlamRunSettings& s)
  {
    try
    {
      (void)runSlam(s);
    }
    catch (const UserError& error)
    {
      return error.what();
    }
    return "no error";
  }

  static fs::path folder_;
};
fs::path SlamRun::folder_;

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

TEST_F(SlamRun, ATruncatedRawlogLeavesTheResultsBeforeTheCut)
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

TEST_F(SlamRun, AStoppedRunLeavesItsResults)
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

TEST_F(SlamRun, StoppedAtTheLastScanItIsComplete)
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

TEST_F(SlamRun, StoppedBeforeTheFirstScanItLeavesTheEarlierRun)
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

TEST_F(SlamRun, AnEarlierRunLeavesNothingBehindInTheFolder)
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

TEST_F(SlamRun, AnOutputThatFailsIsNamedAndTheOthersAreWritten)
{
  auto s = settings("one_fails");
  s.config.set("input.only_first_n=3");
  const fs::path folder = s.output_folder;
  fs::create_directories(folder / "graph.g2o" /
                         "of_the_user");  // a folder that prevents writing the file
  s.force = true;
  const std::string error = errorOf(s);
  EXPECT_NE(error.find("graph.g2o"), std::string::npos) << error;
  EXPECT_EQ(error.find("trajectory"), std::string::npos) << error;
  for (const char* written : {"trajectory_tum.txt", "scans.csv", "labels/000002.label",
                              "replay.rawlog", "map_static.ply", "map.3Dscene", "trajectory.png"})
  {
    EXPECT_TRUE(fs::exists(folder / written)) << written;
  }
  EXPECT_NE(readWhole(folder / "report.json").find("graph.g2o: "), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "factor_graph.txt"));
}

TEST_F(SlamRun, WhatNoRunWroteIsNotReplaced)
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

TEST_F(SlamRun, WarnsWhereNothingMeasuresTheMotion)
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
TEST_F(SlamRun, ARunThatFailedSaysSo)
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

TEST_F(SlamRun, EmptyScansAndBadPointsDoNotStopIt)
{
  auto s = settings("spoiled");
  s.rawlog = (folder_ / "spoiled.rawlog").string();
  writeRecording(s.rawlog, town(), scan_count, true);
  const auto report = runSlam(s);
  EXPECT_EQ(report.frames, static_cast<std::size_t>(scan_count));
  EXPECT_EQ(report.unconverged, 1U);
  EXPECT_LT(errorsOf(s.output_folder).end.percent, 3.0);
}

TEST_F(SlamRun, BadConfigIsNamedBeforeAnythingIsWritten)
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

TEST_F(SlamRun, AnOutputFolderThatCannotBeMadeIsNamed)
{
  auto s = settings("x");
  s.output_folder = "/proc/dyslam-out";
  EXPECT_NE(errorOf(s).find("/proc/dyslam-out"), std::string::npos);
  std::ofstream(folder_ / "file") << "x";
  s.output_folder = (folder_ / "file" / "below").string();
  EXPECT_NE(errorOf(s).find("output"), std::string::npos);
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
