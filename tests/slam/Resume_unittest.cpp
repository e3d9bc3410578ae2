// SPDX-License-Identifier: BSD-3-Clause
// Runs that were stopped or killed continue from their last checkpoint and give the same bytes.
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/run/RunSlam.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr int street_scans = 24;
constexpr const char* state_name = "resume.state";

/** A report without the lines that hold clock times and memory. */
std::string figuresOf(const std::string& report)
{
  std::string figures;
  std::istringstream lines(report);
  bool timed = false;
  for (std::string line; std::getline(lines, line);)
  {
    timed = timed || line.find("_ms\": {") != std::string::npos ||
            line.find("memory_mb") != std::string::npos;
    const bool time = timed || line.find("run_time") != std::string::npos ||
                      line.find("realtime") != std::string::npos ||
                      line.find("ms_per_scan") != std::string::npos;
    figures += time ? "" : line + "\n";
    timed = timed && line.find('}') == std::string::npos;
  }
  return figures;
}

/** Content of every file of a run by name, without clock times and the settings of checkpoints. */
std::map<std::string, std::string> comparableFiles(const fs::path& folder)
{
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
  {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (!entry.is_regular_file() || name == "effective.ini" || name == ".dyslam.lock")
    {
      continue;
    }
    const std::string content = readWhole(entry.path());
    files[name] = name == "report.json"   ? figuresOf(content)
                  : name == "report.html" ? content.substr(content.find("\"scans\":"))
                                          : content;
  }
  return files;
}

void expectSameFiles(const fs::path& a, const fs::path& b)
{
  const auto files = comparableFiles(a);
  const auto others = comparableFiles(b);
  for (const auto& [name, content] : files)
  {
    const auto other = others.find(name);
    ASSERT_TRUE(other != others.end()) << name << " is missing in " << b;
    EXPECT_TRUE(other->second == content) << name << " differs in " << b;
  }
  for (const auto& [name, content] : others)
  {
    EXPECT_EQ(files.count(name), 1U) << name << " is only in " << b;
  }
}

class Resume : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ = fs::temp_directory_path() / ("dyslam_resume_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    sim::SimulatorOptions town;
    town.sensor = sim::SensorKind::vlp16;
    town.columns = 400;
    town.traffic = 0.5;
    town.seed = 11;
    town.further_sensors = {{sim::SensorKind::vlp16, poseFromYpr(-1, 0, 1, M_PI, 0, 0)}};
    town.imu = true;
    town.wheels = true;
    sim::Simulator simulator(town, 1);
    RawlogWriter with_samples(recordingWithSamples());
    RawlogWriter writer(recording());
    for (int i = 0; i < street_scans; ++i)
    {
      const auto simulated = simulator.next();
      writer.write(simulated.scan, simulated.T_map_vehicle);
      writer.write(simulated.further.front());
      for (const ImuSample& sample : simulated.imu)
      {
        with_samples.write(sample);
      }
      for (const WheelSample& sample : simulated.wheels)
      {
        with_samples.write(sample);
      }
      with_samples.write(simulated.scan, simulated.T_map_vehicle);
    }
    writer.close();
    with_samples.close();
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string recording() { return (folder_ / "town.rawlog").string(); }

  /** The same scans, of the first lidar alone, with an IMU and wheel odometry. */
  static std::string recordingWithSamples() { return (folder_ / "samples.rawlog").string(); }

  static SlamRunSettings settings(const std::string& output,
                                  const std::vector<std::string>& assignments,
                                  const std::string& rawlog = recording())
  {
    SlamRunSettings s;
    s.rawlog = rawlog;
    s.output_folder = (folder_ / output / "run").string();  // "run": pictures show the name
    s.config =
        Config::fromFile(std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/vlp16.ini");
    s.labels = true;
    s.static_scans = true;
    for (const std::string& assignment : assignments)
    {
      s.config.set(assignment);
    }
    return s;
  }

  /** Copies a run's folder as if the run was killed now; the state first, because the other files
   * may be ahead of it. */
  static void snapshot(const fs::path& from, const fs::path& to)
  {
    while (!fs::exists(from / state_name))
    {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    fs::create_directories(to);
    fs::copy_file(from / state_name, to / state_name);
    for (const auto& entry : fs::recursive_directory_iterator(from))
    {
      const fs::path target = to / fs::relative(entry.path(), from);
      std::error_code ignored;  // a file may be renamed at this moment
      if (entry.is_directory(ignored))
      {
        fs::create_directories(target);
      }
      else if (entry.path().filename() != state_name)
      {
        fs::copy_file(entry.path(), target, ignored);
      }
    }
  }

  /** Runs to the end, and leaves in `copy` what a kill after this many scans would have left. */
  static void runWithCopy(const SlamRunSettings& run, std::size_t after, const fs::path& copy)
  {
    (void)runSlam(run,
                  [&](double, std::size_t scans)
                  {
                    if (scans == after)
                    {
                      snapshot(run.output_folder, copy);
                    }
                  });
  }

  static SlamRunReport resume(const fs::path& run)
  {
    SlamRunSettings s;
    s.output_folder = run.string();
    return resumeSlam(s);
  }

  /** Expects the progress of the scans that are done, not of those that are read ahead. */
  static void expectSteadyProgress(double fraction, std::size_t scans)
  {
    EXPECT_NEAR(static_cast<double>(scans), fraction * street_scans, 3);
  }

  /** Runs with a checkpoint at every scan, and resumes copies of the run from after each of
   * `stops`. */
  static void expectResumes(const std::string& name,
                            std::vector<std::string> assignments,
                            const std::vector<std::size_t>& stops)
  {
    SlamRunSettings whole = settings(name, assignments);
    whole.config.set("output.checkpoint_seconds=0");
    const SlamRunReport report = runSlam(whole, expectSteadyProgress);
    EXPECT_EQ(report.frames, static_cast<std::size_t>(street_scans));
    EXPECT_FALSE(fs::exists(fs::path(whole.output_folder) / state_name));

    assignments.emplace_back("output.checkpoint_seconds=1e-6");
    const SlamRunSettings killed = settings(name + "_killed", assignments);
    const auto copyOf = [&](std::size_t stop)
    { return folder_ / (name + "_" + std::to_string(stop)) / "run"; };
    (void)runSlam(killed,
                  [&](double, std::size_t scans)
                  {
                    if (std::find(stops.begin(), stops.end(), scans) != stops.end())
                    {
                      snapshot(killed.output_folder, copyOf(scans));
                    }
                  });
    expectSameFiles(whole.output_folder, killed.output_folder);  // checkpoints change nothing
    for (const std::size_t stop : stops)
    {
      SCOPED_TRACE(name + ", killed after scan " + std::to_string(stop));
      EXPECT_NE(readWhole(copyOf(stop) / "report.json").find("\"finished\": false"),
                std::string::npos);
      EXPECT_EQ(resume(copyOf(stop)).frames, static_cast<std::size_t>(street_scans));
      expectSameFiles(whole.output_folder, copyOf(stop));
    }
  }

  /** Runs, or resumes, and stops after at least `scans` scans. \return number of scans done */
  static std::size_t stopAfter(SlamRunSettings s, std::size_t scans, bool is_resumed)
  {
    std::size_t done = 0;
    s.stop = [&] { return done >= scans; };
    const auto count = [&done](double, std::size_t frames) { done = frames; };
    try
    {
      (void)(is_resumed ? resumeSlam(s, count) : runSlam(s, count));
      ADD_FAILURE() << "not stopped";
    }
    catch (const UserError& error)
    {
      const std::string what = error.what();
      EXPECT_NE(what.find("stopped on request after " + std::to_string(done) + " scan"),
                std::string::npos)
          << what;
      EXPECT_NE(what.find("dyslam --resume -o " + s.output_folder), std::string::npos) << what;
    }
    return done;
  }

  /** Stops runs after each of `stops` scans, and resumes them. Checkpoints are made only when a run
   * stops. */
  static void expectResumesStopped(const std::string& name,
                                   const std::vector<std::string>& assignments,
                                   const std::vector<std::size_t>& stops,
                                   const std::string& rawlog = recording())
  {
    const SlamRunSettings whole = settings(name, assignments, rawlog);
    (void)runSlam(whole);
    for (const std::size_t stop : stops)
    {
      SCOPED_TRACE(name + ", stopped after scan " + std::to_string(stop));
      const SlamRunSettings stopped =
          settings(name + "_" + std::to_string(stop), assignments, rawlog);
      const fs::path folder = stopped.output_folder;
      const std::size_t done = stopAfter(stopped, stop, false);
      EXPECT_LT(done, static_cast<std::size_t>(street_scans));
      for (const auto& [file, content] : comparableFiles(whole.output_folder))
      {
        const bool later = fs::path(file).has_parent_path() &&  // numbered
                           std::stoul(fs::path(file).stem().string()) >= done;
        EXPECT_EQ(fs::exists(folder / file), !later) << file;
      }
      EXPECT_NE(readWhole(folder / "report.json").find("\"finished\": false"), std::string::npos);
      EXPECT_EQ(resume(folder).frames, static_cast<std::size_t>(street_scans));
      expectSameFiles(whole.output_folder, folder);
    }
  }

  static inline fs::path folder_;
};

TEST_F(Resume, StoppedRunsWithHindsightGiveTheSameBytes)
{
  expectResumesStopped("stop_tracks", {"labels.window=6"}, {1, 9, 14});
}

TEST_F(Resume, StoppedRunsWithTwoLidarsGiveTheSameBytes)
{
  expectResumesStopped(
      "stop_lidars",
      {"labels.window=6", "backend.keyframe_distance=0.5", "input.further_lidars=VLP16_2"}, {11});
}

TEST_F(Resume, StoppedRunsWithObjectsInTheGraphGiveTheSameBytes)
{
  expectResumesStopped(
      "stop_full", {"backend.mode=full", "backend.keyframe_distance=0.5", "labels.hindsight=false"},
      {6, 15});
}

TEST_F(Resume, StoppedRunsWithMotionSensorsAndALevelMapGiveTheSameBytes)
{
  expectResumesStopped("stop_samples",
                       {"labels.window=6", "backend.keyframe_distance=0.5", "gravity.window=0.8",
                        "gravity.level_map=true"},
                       {11}, recordingWithSamples());
  const std::string report = readWhole(folder_ / "stop_samples" / "run" / "report.json");
  EXPECT_NE(report.find("\"levelled\": true"), std::string::npos) << report;
}

TEST_F(Resume, StoppedRunsCanBeStoppedAgain)
{
  const std::vector<std::string> some{"labels.window=6"};
  const SlamRunSettings whole = settings("stop_again", some);
  (void)runSlam(whole);
  const SlamRunSettings stopped = settings("stop_again_twice", some);
  (void)stopAfter(stopped, 5, false);
  SlamRunSettings again;
  again.output_folder = stopped.output_folder;
  (void)stopAfter(again, 14, true);
  (void)resume(stopped.output_folder);
  expectSameFiles(whole.output_folder, stopped.output_folder);
}

TEST_F(Resume, ObjectsLoopsAndHindsightGiveTheSameBytes)
{
  expectResumes("full",
                {"backend.mode=full", "backend.keyframe_distance=0.5", "labels.window=6",
                 "loop.min_path=1", "loop.interval=1", "loop.min_support=0"},
                {2, 12, 21});
  std::ifstream graph(folder_ / "full" / "run" / "factor_graph.txt");
  const std::string text((std::istreambuf_iterator<char>(graph)), std::istreambuf_iterator<char>());
  EXPECT_NE(text.find("LOOP "), std::string::npos) << "no loop was closed";
  EXPECT_NE(text.find("OBSERVATION "), std::string::npos) << "no object is in the graph";
}

TEST_F(Resume, FirstScanIsEnough)
{
  expectResumes("first", {"backend.mode=ego", "dyseg.method=residual", "odometry.method=loam"},
                {1});
}

/** With the network, which encodes each scan in advance while the previous one is processed. */
TEST_F(Resume, TheNetworkGivesTheSameBytes)
{
  expectResumes(
      "network",
      {"dyseg.method=network", "dyseg_network.encode_ahead=true", "labels.hindsight=false"},
      {5, 14});
}

TEST_F(Resume, ResumedRunsCanBeKilledAgain)
{
  const std::vector<std::string> some{"output.checkpoint_seconds=1e-6", "labels.window=6"};
  const SlamRunSettings whole = settings("again", some);
  const fs::path first = folder_ / "again_1" / "run";
  const fs::path second = folder_ / "again_2" / "run";
  runWithCopy(whole, 8, first);
  SlamRunSettings s;
  s.output_folder = first.string();
  (void)resumeSlam(s,
                   [&](double, std::size_t scans)
                   {
                     if (scans == 16)
                     {
                       snapshot(first, second);
                     }
                   });
  expectSameFiles(whole.output_folder, first);
  (void)resume(second);
  expectSameFiles(whole.output_folder, second);
}

TEST_F(Resume, WhatCouldNotBeWrittenAtTheEndIsWrittenByAResumedRun)
{
  const SlamRunSettings whole = settings("end", {"labels.window=6"});
  (void)runSlam(whole);
  const SlamRunSettings lacking =
      settings("end_lacking", {"output.checkpoint_seconds=1e-6", "labels.window=6"});
  const fs::path folder = lacking.output_folder;
  const fs::path in_the_way = folder / "map.3Dscene";
  const std::string error = messageOfError<UserError>(
      [&]
      {
        (void)runSlam(lacking,
                      [&](double, std::size_t scans)
                      {
                        if (scans == 12)
                        {
                          fs::create_directories(in_the_way / "x");
                        }
                      });
      });
  EXPECT_NE(error.find("map.3Dscene"), std::string::npos) << error;
  EXPECT_NE(error.find("complete them with: dyslam --resume -o " + folder.string()),
            std::string::npos)
      << error;
  fs::remove_all(in_the_way);
  (void)resume(folder);
  expectSameFiles(whole.output_folder, folder);
}

/** A replay that could not be written is removed: a checkpoint may still name it. */
TEST_F(Resume, AReplayThatIsNotThereAnyMoreIsMissingAlone)
{
  const SlamRunSettings run = settings("replay", {"output.checkpoint_seconds=1e-6"});
  const fs::path killed = folder_ / "replay_killed" / "run";
  runWithCopy(run, 6, killed);
  ASSERT_TRUE(fs::remove(killed / "replay.rawlog.tmp"));
  const std::string error = messageOfError<UserError>([&] { (void)resume(killed); });
  EXPECT_NE(error.find("replay.rawlog.tmp: cannot be resumed"), std::string::npos) << error;
  EXPECT_EQ(error.find("--resume"), std::string::npos) << error;
  for (const char* file : {"trajectory_tum.txt", "map_static.ply", "scans.csv", "tracks.csv",
                           "static_scans.rawlog", "labels/000003.label", "labels/000023.label"})
  {
    EXPECT_TRUE(readWhole(fs::path(run.output_folder) / file) == readWhole(killed / file)) << file;
  }
  EXPECT_FALSE(fs::exists(killed / state_name));
}

TEST_F(Resume, DamageAndDifferencesAreErrorsThatRemoveNothing)
{
  const SlamRunSettings run = settings("odd", {"output.checkpoint_seconds=1e-6"});
  const fs::path killed = folder_ / "odd_killed" / "run";
  runWithCopy(run, 6, killed);
  const auto before = comparableFiles(killed);
  const std::string state = readWhole(killed / state_name);
  const auto write = [&](const std::string& bytes)
  { std::ofstream(killed / state_name, std::ios::binary) << bytes; };
  const auto expectRefused = [&](SlamRunSettings s, const std::string& why)
  {
    s.output_folder = killed.string();
    try
    {
      (void)resumeSlam(s);
      ADD_FAILURE() << why;
    }
    catch (const UserError& error)
    {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  std::string damaged = state;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  write(damaged);
  expectRefused({}, "is damaged");
  write(state.substr(0, state.size() - 1));
  expectRefused({}, "is cut short");
  write("");
  expectRefused({}, "is cut short");
  write("x" + state);
  expectRefused({}, "no state of a run");
  write(state);
  SlamRunSettings other;
  other.config.set("map.voxel_size=0.7");
  expectRefused(other, "map.voxel_size is 0.7");
  other = {};
  other.probabilities = true;
  expectRefused(other, "--probabilities: the run to resume was started without it");
  other = {};
  other.rawlog = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";
  expectRefused(other, "has another size");
  EXPECT_TRUE(comparableFiles(killed) == before);
  fs::rename(killed / "scans.csv.tmp", folder_ / "scans.csv.tmp");
  expectRefused({}, "scans.csv.tmp");
  fs::rename(folder_ / "scans.csv.tmp", killed / "scans.csv.tmp");
  (void)resume(killed);
  expectSameFiles(run.output_folder, killed);
  expectRefused({}, "nothing to resume");
}
}  // namespace
}  // namespace dyslam
