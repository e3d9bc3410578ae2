// SPDX-License-Identifier: BSD-3-Clause
// Programs with bad input: each must print one line that names the file or field and what to do,
// end with exit code 1, and leave no partial files.
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "RunProgram.h"

namespace dyslam::test
{
inline constexpr std::size_t recorded_scans = 12;

/** A short recording, and files that are none, in the folder that the tests of a suite share. */
class RefusedInput : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ =
        std::filesystem::temp_directory_path() / ("dyslam_refused_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    record("good.rawlog", [](std::size_t, Scan&) { return true; });
    write("file", "x");
    write("empty", "");
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  /** Writes a short recording. \param change modifies its scans */
  static void record(const std::string& name, const std::function<void(std::size_t, Scan&)>& change)
  {
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 600;
    options.traffic = 0.3;
    options.seed = 5;
    sim::Simulator simulator(options, 1);
    RawlogWriter writer(at(name));
    for (std::size_t i = 0; i < recorded_scans; ++i)
    {
      auto simulated = simulator.next();
      change(i, simulated.scan);
      writer.write(simulated.scan, simulated.T_map_vehicle);
    }
    writer.close();
  }

  static std::string at(const std::string& name) { return (folder_ / name).string(); }

  static std::string write(const std::string& name, const std::string& content)
  {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return at(name);
  }

  /** \param arguments words without blanks or quotes. */
  static Outcome run(const std::string& program, const std::string& arguments)
  {
    return runProgram(program, arguments, folder_.string());
  }

  /** Fails unless the program ends with 1 and its only line on stderr has all of `parts`. */
  static void expectRefusal(const std::string& program,
                            const std::string& arguments,
                            const std::vector<std::string>& parts)
  {
    const Outcome outcome = run(program, arguments);
    const std::string shown = program + " " + arguments + "\n" + outcome.err;
    EXPECT_EQ(outcome.code, 1) << shown;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << shown;
    EXPECT_EQ(outcome.err.rfind(program + ": ", 0), 0U) << shown;
    for (const auto& part : parts)
    {
      EXPECT_NE(outcome.err.find(part), std::string::npos) << "no '" << part << "' in\n" << shown;
    }
  }

  static std::string slam(const std::string& rawlog, const std::string& output)
  {
    return "-i " + rawlog + " -c vlp16.ini -o " + at(output);
  }

  static std::size_t posesIn(const std::string& run_folder)
  {
    return readTum(at(run_folder) + "/trajectory_tum.txt").size();
  }

  inline static std::filesystem::path folder_;
};
}  // namespace dyslam::test
