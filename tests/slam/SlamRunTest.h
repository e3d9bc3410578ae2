// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/eval/TrajectoryMetrics.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/run/RunSlam.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <map>
#include <string>

namespace dyslam
{
/** Runs on a recording of a small town, in a folder of the suite. */
class SlamRunTest : public ::testing::Test
{
 protected:
  static constexpr int scan_count = 40;

  static void SetUpTestSuite()
  {
    folder_ =
        std::filesystem::temp_directory_path() / ("dyslam_slam_run_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    writeRecording(recording(), town(), scan_count, false);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

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

  /** Content of every file of a run by name, without files that hold clock times. */
  static std::map<std::string, std::string> filesOf(const std::filesystem::path& folder)
  {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    {
      const std::string name = std::filesystem::relative(entry.path(), folder).string();
      if (entry.is_regular_file() && name != "report.json" && name != "effective.ini")
      {
        const std::string content = readWhole(entry.path());
        // Before the scans, the page has title, settings and times.
        files[name] = name == "report.html" ? content.substr(content.find("\"scans\":")) : content;
      }
    }
    return files;
  }

  /** Motion between the two poses of a run of two scans. */
  static Pose firstStep(const SlamRunSettings& s, const char* file)
  {
    const Trajectory poses = readTum((std::filesystem::path(s.output_folder) / file).string());
    EXPECT_EQ(poses.size(), 2U) << file;
    return poses.size() == 2 ? poses[0].pose.inverse() * poses[1].pose : Pose::Identity();
  }

  static TrajectoryReport errorsOf(const std::filesystem::path& run)
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

  inline static std::filesystem::path folder_;
};
}  // namespace dyslam
