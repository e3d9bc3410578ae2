// SPDX-License-Identifier: BSD-3-Clause
// One drive in many formats: what the programs read of each must be the same.
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "RunProgram.h"

namespace dyslam::test
{
inline constexpr std::size_t drive_scans = 6;

/** A short simulated drive of a VLP-16 with true poses, in the folder that the tests of a suite
 * share. */
class ConvertedDrive : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    scans_.clear();
    poses_.clear();
    folder_ =
        std::filesystem::temp_directory_path() / ("dyslam_drive_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 600;
    options.seed = 5;
    sim::Simulator simulator(options, 1);
    RawlogWriter writer(at("original.rawlog"));
    for (std::size_t i = 0; i < drive_scans; ++i)
    {
      auto simulated = simulator.next();
      simulated.scan.T_vehicle_lidar = Pose::Identity();
      simulated.scan.sensor_label = "lidar";
      writer.write(simulated.scan);
      scans_.push_back(simulated.scan);
      poses_.push_back(simulated.T_map_vehicle);
    }
    writer.close();
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static std::string at(const std::string& name) { return (folder_ / name).string(); }
  static void makeFolder(const std::string& name)
  {
    std::filesystem::create_directories(folder_ / name);
  }
  static void write(const std::string& name, const std::string& text)
  {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  static Outcome run(const std::string& program, const std::string& arguments)
  {
    return runProgram(program, arguments, folder_.string());
  }

  /** Converts a recording, expects success, and reads the result. \param says parts of the
   * converter's output */
  static std::vector<Frame> converted(const std::string& program,
                                      const std::string& arguments,
                                      const std::vector<std::string>& says = {})
  {
    const Outcome outcome = run(program, arguments + " -q --force -o " + at("out.rawlog"));
    EXPECT_EQ(0, outcome.code) << program << ' ' << arguments << '\n' << outcome.err;
    for (const std::string& part : says)
    {
      EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\nnot in\n" << outcome.err;
    }
    std::vector<Frame> frames;
    RawlogSource source(at("out.rawlog"));
    while (auto frame = source.next())
    {
      frames.push_back(std::move(*frame));
    }
    return frames;
  }

  static void expectOriginal(const std::vector<Frame>& frames)
  {
    ASSERT_EQ(drive_scans, frames.size());
    for (std::size_t i = 0; i < drive_scans; ++i)
    {
      EXPECT_EQ(scans_[i].points, frames[i].scan.points);
      EXPECT_EQ(scans_[i].intensity, frames[i].scan.intensity);
    }
  }

  /** Writes the scans as .bin files. \param name folder \param file stem of a scan's file name, by
   * number */
  static void bins(const std::string& name,
                   const std::function<std::string(std::size_t)>& file,
                   const std::string& ending = ".bin")
  {
    makeFolder(name);
    for (std::size_t i = 0; i < drive_scans; ++i)
    {
      writeCloud(at(name + "/" + file(i) + ending), scans_[i].points, scans_[i].intensity);
    }
  }
  static std::string counted(std::size_t i) { return "00000" + std::to_string(i); }

  static std::string slam(const std::string& rawlog, const std::string& output)
  {
    const Outcome outcome = run("dyslam", "-i " + rawlog + " -v ERROR -o " + at(output));
    EXPECT_EQ(0, outcome.code) << outcome.err;
    return contentOf(at(output) + "/trajectory_kitti.txt");
  }

  inline static std::filesystem::path folder_;
  inline static std::vector<Scan> scans_;
  inline static std::vector<Pose> poses_;  // T_map_vehicle
};
}  // namespace dyslam::test
