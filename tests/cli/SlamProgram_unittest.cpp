// SPDX-License-Identifier: BSD-3-Clause
// Messages and exit codes of the programs for runs in one pass and in two.
#include "../../apps/common/SlamProgram.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../../apps/common/AppMain.h"
#include "../../apps/common/StopSignals.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
const std::string campus = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";

class SlamProgramTest : public ::testing::Test
{
 protected:
  SlamProgramTest()
  {
    a_.settings.rawlog = campus;
    a_.settings.output_folder = folder_.file("run");
    a_.verbosity = "ERROR";
    a_.range.only_first_n = 2;
    report_.frames = 2;
    report_.path_length = 100;
    stop_asked = false;
  }
  ~SlamProgramTest() override { stop_asked = false; }

  /** Replaces runs of SLAM: records the settings and writes only labels. */
  SlamRunner runner()
  {
    return [this](const SlamRunSettings& settings, const auto& on_frame)
    {
      runs_.push_back(settings);
      on_frame(0.5, 1);
      fs::create_directories(settings.output_folder + "/labels");
      std::ofstream(settings.output_folder + "/labels/000000.label") << "0000";
      SlamRunReport report = report_;
      report.path_length += runs_.size() == 2 ? longer_ : 0;
      report.first_pass_time = settings.first_pass_time;
      report.run_time += settings.first_pass_time;
      report.warnings.insert(report.warnings.begin(), settings.warnings.begin(),
                             settings.warnings.end());
      return report;
    };
  }
  void run() { runSlamProgram("dyslam", a_, runner()); }
  std::string errorOfRun()
  {
    try
    {
      run();
    }
    catch (const std::runtime_error& error)
    {
      return error.what();
    }
    return "none";
  }
  std::string printedByRun()
  {
    a_.verbosity = "INFO";
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    run();
    const std::string err = testing::internal::GetCapturedStderr();
    return testing::internal::GetCapturedStdout() + err;
  }

  TestFolder folder_;
  SlamArguments a_;
  SlamRunReport report_;
  double longer_ = 0;  //!< length of the second run's path [m]
  std::vector<SlamRunSettings> runs_;
};

TEST_F(SlamProgramTest, StoppedWhileItStartsItRunsNothing)
{
  for (const int passes : {1, 2})
  {
    a_.passes = passes;
    stop_asked = true;
    EXPECT_EQ(errorOfRun(), campus + ": stopped before the first scan");
    EXPECT_TRUE(runs_.empty());
    EXPECT_FALSE(fs::exists(folder_.file("run")));
  }
}

TEST_F(SlamProgramTest, WarningsOfTheFirstPassArePrintedOnce)
{
  a_.passes = 2;
  report_.second_pass_advice = "17 % of the points move";
  report_.warnings = {"the clock was set", report_.second_pass_advice};
  const std::string printed = printedByRun();
  ASSERT_EQ(2U, runs_.size());
  const std::size_t first = printed.find("warning: first pass: the clock was set\n");
  EXPECT_NE(first, std::string::npos) << printed;
  EXPECT_EQ(printed.find("first pass: the clock", first + 30), std::string::npos) << printed;
  EXPECT_TRUE(contains(printed, "warning: the clock was set\n")) << printed;
  EXPECT_FALSE(contains(printed, "first pass: 17 %")) << printed;
  EXPECT_FALSE(contains(printed, "the path is")) << printed;
}

TEST_F(SlamProgramTest, AFirstPassThatFailedEndsIt)
{
  a_.passes = 2;
  report_.failure = "2 of 2 scans could not be registered";
  EXPECT_THROW(run(), UnusableResult);
  EXPECT_EQ(1U, runs_.size());
  EXPECT_EQ("first pass: 2 of 2 scans could not be registered", errorOfRun());
}

TEST_F(SlamProgramTest, PathsOfDifferentLengthsAreAWarning)
{
  a_.passes = 2;
  longer_ = 12;
  const std::string printed = printedByRun();
  EXPECT_TRUE(
      contains(printed, "warning: the path is 112.0 m long, that of the first pass 100.0 m"))
      << printed;
}

TEST_F(SlamProgramTest, WarningsDuringTheRunArePrintedOnce)
{
  const std::string warning = "checkpoints could not be written";
  report_.warnings = {warning, "another"};
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  a_.verbosity = "INFO";
  runSlamProgram("dyslam", a_,
                 [&](const SlamRunSettings& settings, const auto& on_frame)
                 {
                   settings.warn(warning);
                   return runner()(settings, on_frame);
                 });
  EXPECT_TRUE(contains(testing::internal::GetCapturedStderr(), "warning: " + warning));
  const std::string out = testing::internal::GetCapturedStdout();
  EXPECT_FALSE(contains(out, warning)) << out;
  EXPECT_TRUE(contains(out, "warning: another")) << out;
}

TEST_F(SlamProgramTest, SensorAndSettingsArePrintedInTheFirstPassOnly)
{
  const std::string settings = "dyslam: 16 rings, ";
  for (const int passes : {1, 2})
  {
    a_.passes = passes;
    const std::string printed = printedByRun();
    const std::size_t first = printed.find(settings);
    ASSERT_NE(first, std::string::npos) << printed;
    EXPECT_TRUE(contains(printed, "; settings: vlp16.ini\n")) << printed;
    EXPECT_EQ(printed.find(settings, first + 1), std::string::npos) << printed;
    EXPECT_FALSE(contains(printed, "replaces the earlier run")) << printed;
  }
  std::ofstream(folder_.file("run/report.json")) << "{}";
  a_.passes = 1;
  EXPECT_TRUE(contains(printedByRun(),
                       "dyslam: replaces the earlier run in " + folder_.file("run") + "\n"));
}

TEST_F(SlamProgramTest, TheWallTimeOfAScanIsPrinted)
{
  report_.ms_per_scan = 60;
  report_.run_time = 0.1;
  report_.method = "residual + gicp";
  const std::string printed = printedByRun();
  EXPECT_TRUE(contains(
      printed, "60.0 ms per scan, all stages added up, some in parallel; 50.0 ms of wall time"));
  EXPECT_TRUE(contains(printed, "methods: residual + gicp\n"));
}

TEST_F(SlamProgramTest, TheTimeOfBothPassesIsPrinted)
{
  a_.passes = 2;
  report_.run_time = 0.1;
  report_.recording_time = 0.3;
  const std::string printed = printedByRun();
  EXPECT_TRUE(
      contains(printed, "real-time factor 1.50: 0.3 s of recording in 0.2 s, both passes\n"))
      << printed;
  EXPECT_TRUE(contains(printed, "; 50.0 ms of wall time\n")) << printed;
}

TEST_F(SlamProgramTest, OneScanIsNamedAsOne)
{
  report_.unconverged = 1;
  EXPECT_TRUE(contains(printedByRun(), "1 scan could not be registered; its motion is predicted"));
  report_.unconverged = 2;
  EXPECT_TRUE(
      contains(printedByRun(), "2 scans could not be registered; their motion is predicted"));
}
}  // namespace
}  // namespace dyslam
