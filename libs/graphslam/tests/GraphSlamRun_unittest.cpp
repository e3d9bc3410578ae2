// SPDX-License-Identifier: BSD-3-Clause
// Whole runs of MRPT's engine, compared with the pipeline's own.
#include <dyslam/base/Error.h>
#include <dyslam/graphslam/GraphSlamRun.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogStream.h>
#include <dyslam/io/RawlogWriter.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "Fixture.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr int scan_count = 40;

class GraphSlamRun : public test::WithFolder
{
 protected:
  static SlamRunSettings settings(const std::string& output)
  {
    SlamRunSettings s;
    s.rawlog = test::bundled("rawlog/campus16.rawlog");
    s.output_folder = pathOf(output);
    s.config = test::loopyConfig(scan_count);
    s.labels = true;
    return s;
  }

  static std::string errorOf(const SlamRunSettings& s, const GraphSlamPluginNames& plugins = {})
  {
    try
    {
      (void)runGraphSlam(s, plugins);
      return "";
    }
    catch (const UserError& error)
    {
      return error.what();
    }
  }

  static std::set<std::string> namesIn(const fs::path& folder)
  {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
    {
      names.insert(fs::relative(entry.path(), folder).string());
    }
    return names;
  }

  /** Expects the bytes of every file of a run in another one, but of those with times.
   * \return their names */
  static std::set<std::string> expectFilesOf(const SlamRunSettings& own,
                                             const SlamRunSettings& engine)
  {
    const std::set<std::string> names = namesIn(own.output_folder);
    for (const std::string& name : names)
    {
      const bool has_times = name == "report.json" || name == "report.html";
      if (!has_times && fs::is_regular_file(fs::path(own.output_folder) / name))
      {
        EXPECT_TRUE(test::contentOf(fs::path(own.output_folder) / name) ==
                    test::contentOf(fs::path(engine.output_folder) / name))
            << name;
      }
    }
    return names;
  }
};

/** Writes the first scans of a recording as those of two lidars: every second point is of one that
 * looks back, recorded shortly before the first one. */
void splitInTwoLidars(const std::string& rawlog, int scans, const std::string& output)
{
  constexpr double earlier = 0.01;  // [s]
  const Pose T_front_rear = poseFromYpr(-1, 0.2, 0, M_PI, 0, 0);
  RawlogSource source(rawlog, RawlogSourceOptions());
  RawlogWriter writer(output);
  for (int i = 0; i < scans; ++i)
  {
    const Scan whole = source.next().value().scan;
    Scan front;
    front.stamp = whole.stamp;
    front.T_vehicle_lidar = whole.T_vehicle_lidar;
    front.sensor_label = "front";
    Scan rear = front;
    rear.stamp -= earlier;
    rear.T_vehicle_lidar = front.T_vehicle_lidar * T_front_rear;
    rear.sensor_label = "rear";
    for (std::size_t k = 0; k < whole.size(); ++k)
    {
      const bool is_front = k % 2 == 0 || !isReturn(whole.points[k]);
      Scan& scan = is_front ? front : rear;
      scan.points.push_back(
          is_front ? whole.points[k]
                   : (T_front_rear.inverse() * whole.points[k].cast<double>()).cast<float>());
      scan.intensity.push_back(whole.intensity.at(k));
      scan.time.push_back(whole.time.at(k) + (is_front ? 0 : static_cast<float>(earlier)));
      scan.ring.push_back(whole.ring.at(k));
    }
    writer.write(rear);
    writer.write(front);
  }
  writer.close();
}

TEST_F(GraphSlamRun, GivesTheBytesOfThePipeline)
{
  const auto own = settings("a/run");
  const auto engine = settings("b/run");
  const SlamRunReport expected = runSlam(own);
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  std::size_t calls = 0;
  const SlamRunReport report = runGraphSlam(engine, {}, [&](double, std::size_t) { ++calls; });
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");

  EXPECT_EQ(expected.frames, static_cast<std::size_t>(scan_count));
  EXPECT_GT(expected.loops, 3U) << "this recording should test loops";
  EXPECT_EQ(report.frames, expected.frames);
  EXPECT_EQ(report.loops, expected.loops);
  EXPECT_EQ(report.keyframes, expected.keyframes);
  EXPECT_GE(calls + 2, static_cast<std::size_t>(scan_count));

  auto names = expectFilesOf(own, engine);
  EXPECT_GT(names.size(), static_cast<std::size_t>(scan_count));
  for (const char* name :
       {"output_graph.graph", "CGraphSlamEngine.log", "timings.log", "engine.ini",
        "node_registrar.log", "edge_registrar.log", "optimizer.log"})
  {
    EXPECT_TRUE(names.insert(name).second);
  }
  EXPECT_EQ(namesIn(engine.output_folder), names);
  // The engine's network is the backend's graph.
  EXPECT_TRUE(test::contentOf(fs::path(engine.output_folder) / "output_graph.graph") ==
              test::contentOf(fs::path(own.output_folder) / "graph.graph"));
}

TEST_F(GraphSlamRun, GivesTheBytesOfThePipelineForSeveralLidars)
{
  constexpr int scans = 12;
  auto own = settings("two_a/run");
  own.rawlog = pathOf("two.rawlog");
  splitInTwoLidars(test::bundled("rawlog/campus16.rawlog"), scans, own.rawlog);
  own.config = test::loopyConfig(scans);
  own.config.set("input.further_lidars=rear");
  auto engine = own;
  engine.output_folder = pathOf("two_b/run");
  EXPECT_EQ(runSlam(own).frames, static_cast<std::size_t>(scans));
  EXPECT_EQ(runGraphSlam(engine).frames, static_cast<std::size_t>(scans));
  EXPECT_EQ(expectFilesOf(own, engine).count("scan_parts.csv"), 1U);
  const std::string parts = test::contentOf(fs::path(engine.output_folder) / "scan_parts.csv");
  EXPECT_EQ(std::count(parts.begin(), parts.end(), '\n'), 1 + scans);
}

/** MRPT's engine waits for a key: without ConsoleCutOff the test would wait for ever. */
TEST_F(GraphSlamRun, NeverReadsFromTheKeyboard)
{
  int keyboard[2];
  ASSERT_EQ(pipe(keyboard), 0);  // an open pipe that nobody writes to
  const int stdin_before = dup(STDIN_FILENO);
  dup2(keyboard[0], STDIN_FILENO);
  auto s = settings("keyboard");
  s.labels = false;
  s.config.set("input.only_first_n=3");
  EXPECT_EQ(runGraphSlam(s).frames, 3U);
  ASSERT_EQ(write(keyboard[1], "k", 1), 1);
  EXPECT_EQ(std::getchar(), 'k') << "standard input is the program's again";
  dup2(stdin_before, STDIN_FILENO);
  for (const int descriptor : {keyboard[0], keyboard[1], stdin_before})
  {
    close(descriptor);
  }
}

TEST_F(GraphSlamRun, WithoutLoopsGivesWhatTheBackendGivesWithoutLoops)
{
  auto own = settings("odometry");
  own.config.set("backend.mode=odometry");
  own.labels = false;
  auto engine = settings("no_loops");
  engine.labels = false;
  (void)runSlam(own);
  const SlamRunReport report = runGraphSlam(engine, {"", "CEmptyERD", ""});
  EXPECT_EQ(report.loops, 0U);
  for (const char* name : {"trajectory_tum.txt", "graph.graph"})
  {
    EXPECT_EQ(test::contentOf(fs::path(own.output_folder) / name),
              test::contentOf(fs::path(engine.output_folder) / name));
  }
}

TEST_F(GraphSlamRun, UnknownPluginsNameTheNearest)
{
  auto s = settings("unknown");
  EXPECT_EQ(errorOf(s, {"OdometryNodeDecidr", "", ""}),
            "unknown node registration decider 'OdometryNodeDecidr'; did you mean "
            "'OdometryNodeDecider'? (one of: OdometryNodeDecider)");
  EXPECT_EQ(errorOf(s, {"", "x", ""}),
            "unknown edge registration decider 'x' (one of: LoopEdgeDecider, CEmptyERD)");
  const std::string optimizer = errorOf(s, {"", "", "FactorGraphOptimiser"});
  EXPECT_EQ(optimizer.find("unknown optimizer 'FactorGraphOptimiser'; did you mean "
                           "'FactorGraphOptimizer'? (one of: FactorGraphOptimizer)"),
            0U)
      << optimizer;
  const std::string folder = errorOf(s, {"", "", "out/gs"});
  EXPECT_EQ(folder.find("unknown optimizer 'out/gs' (one of: FactorGraphOptimizer)"), 0U) << folder;
  EXPECT_NE(folder.find(" (the folder for results is --output)"), std::string::npos) << folder;
  EXPECT_FALSE(fs::exists(s.output_folder));
}

TEST_F(GraphSlamRun, StoppedBeforeTheFirstScanItLeavesTheFolderAlone)
{
  auto s = settings("never");
  s.stop = [] { return true; };
  EXPECT_EQ(errorOf(s), s.rawlog + ": stopped before the first scan");
  EXPECT_FALSE(fs::exists(s.output_folder));
}

TEST_F(GraphSlamRun, BadRecordingsAreRefusedBeforeAnythingIsWritten)
{
  auto s = settings("bad");
  s.rawlog = pathOf("missing.rawlog");
  EXPECT_EQ(errorOf(s), s.rawlog + ": no such file");

  s.rawlog = pathOf("no_scans.rawlog");
  {
    mrpt::io::CFileGZOutputStream file(s.rawlog);
    auto archive = mrpt::serialization::archiveFrom(file);
    mrpt::obs::CObservationRobotPose pose;
    pose.timestamp = mrpt::Clock::now();
    archive << pose;
  }
  EXPECT_EQ(errorOf(s), s.rawlog +
                            ": has no 3D scans, only 1 CObservationRobotPose; give a "
                            "recording of a 3D LiDAR");
  EXPECT_FALSE(fs::exists(s.output_folder));
}

/** As runSlam(), the run keeps the results of the scans before the damage. */
TEST_F(GraphSlamRun, ACutRecordingLeavesTheResultsOfItsWholeScans)
{
  const std::string whole = test::contentOf(test::bundled("rawlog/campus16.rawlog"));
  auto own = settings("cut_own");
  own.config.set("input.only_first_n=0");
  own.labels = false;
  own.rawlog = pathOf("cut.rawlog");
  std::ofstream(own.rawlog, std::ios::binary).write(whole.data(), 1 << 20);
  auto engine = own;
  engine.output_folder = pathOf("cut_engine");
  EXPECT_THROW((void)runSlam(own), UserError);
  const std::string error = errorOf(engine);
  EXPECT_NE(error.find("is cut short"), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  const auto trajectory = test::contentOf(fs::path(own.output_folder) / "trajectory_tum.txt");
  EXPECT_FALSE(trajectory.empty());
  EXPECT_EQ(trajectory, test::contentOf(fs::path(engine.output_folder) / "trajectory_tum.txt"));
}

TEST_F(GraphSlamRun, AnExceptionThatIsNoUsersLeavesTheResultsOfTheScansBefore)
{
  constexpr std::size_t whole_scans = 6;
  auto engine = settings("failing_engine");
  engine.labels = false;
  const auto fail = [](double, std::size_t frames)
  {
    if (frames == whole_scans)
    {
      throw std::runtime_error("out of something");
    }
  };
  try
  {
    (void)runGraphSlam(engine, {}, fail);
    ADD_FAILURE() << "nothing was thrown";
  }
  catch (const UserError& error)
  {
    EXPECT_EQ(std::string(error.what()).rfind("out of something; results of the ", 0), 0U)
        << error.what();
  }
  const std::string folder = engine.output_folder + "/";
  const std::string poses = test::contentOf(folder + "trajectory_tum.txt");
  EXPECT_GE(static_cast<std::size_t>(std::count(poses.begin(), poses.end(), '\n')), whole_scans);
  EXPECT_TRUE(fs::exists(folder + "report.json"));
  EXPECT_TRUE(fs::exists(folder + "output_graph.graph"));
}

/** Observations without a time stamp would make the engine throw. */
TEST_F(GraphSlamRun, ObservationsWithoutTimeArePassedOver)
{
  auto s = settings("timeless");
  s.labels = false;
  s.rawlog = pathOf("timeless.rawlog");
  {
    mrpt::io::CFileGZOutputStream file(s.rawlog);
    auto archive = mrpt::serialization::archiveFrom(file);
    RawlogStream stream(test::bundled("rawlog/campus16.rawlog"));
    for (int i = 0; i < 24; ++i)
    {
      const auto observation = stream.next();
      ASSERT_TRUE(observation);
      if (i >= 12 && i < 16)
      {
        observation->timestamp = INVALID_TIMESTAMP;
      }
      archive << *observation;
    }
  }
  const SlamRunReport report = runGraphSlam(s);
  auto own = s;
  own.output_folder = pathOf("timeless_own");
  const SlamRunReport expected = runSlam(own);
  EXPECT_GT(report.frames, 3U);
  EXPECT_EQ(report.frames, expected.frames);
  EXPECT_EQ(report.warnings, expected.warnings);
  EXPECT_FALSE(report.warnings.empty());
}
}  // namespace
}  // namespace dyslam
