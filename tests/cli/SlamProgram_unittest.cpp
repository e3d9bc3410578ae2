// SPDX-License-Identifier: BSD-3-Clause
// How the programs run one pass or two: when they stop, what they refuse, what they say.
#include "../../apps/common/SlamProgram.h"

#include <dyslam/core/Files.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

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
    a_.only_first_n = 2;
    report_.frames = 2;
    report_.path_length = 100;
    stop_asked = false;
  }
  ~SlamProgramTest() override { stop_asked = false; }

  /** Does nothing but labels. */
  SlamRunner runner()
  {
    return [this](const SlamRunSettings& settings, const auto& on_frame)
    {
      runs_.push_back(settings);
      on_frame(0.5, 1);
      fs::create_directories(settings.output_folder + "/labels");
      std::ofstream(settings.output_folder + "/labels/000000.label") << "0000";
      if (runs_.size() == stopped_in_)
      {
        stop_asked = true;  // as by a Ctrl-C while the last files are written
      }
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
  std::size_t stopped_in_ = 0;  //!< number of the run
  double longer_ = 0;           //!< path of the second run [m]
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

TEST_F(SlamProgramTest, StoppedAtTheEndOfTheFirstPassItRunsNoSecond)
{
  a_.passes = 2;
  stopped_in_ = 1;
  const std::string error = errorOfRun();
  EXPECT_TRUE(contains(error, ": stopped after the first pass")) << error;
  EXPECT_EQ(1U, runs_.size());
  EXPECT_TRUE(fs::exists(folder_.file("run/labels/000000.label")));
}

TEST_F(SlamProgramTest, StoppedAtTheEndOfTheOnlyPassItHasEnded)
{
  stopped_in_ = 1;
  EXPECT_EQ("none", errorOfRun());
}

TEST_F(SlamProgramTest, TheSecondPassHasTheWarningsOfTheFirst)
{
  a_.passes = 2;
  report_.second_pass_advice = "17 % of the points move";
  report_.warnings = {"the clock was set", report_.second_pass_advice};
  const std::string printed = printedByRun();
  ASSERT_EQ(2U, runs_.size());
  EXPECT_EQ(std::vector<std::string>{"first pass: the clock was set"}, runs_[1].warnings);
  EXPECT_EQ(folder_.file("run/first_pass/labels"),
            runs_[1].config.section("dyseg").at("labels").text);
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
  EXPECT_EQ("", comparePaths(100, 109));
  EXPECT_NE("", comparePaths(100, 80));
  EXPECT_EQ("", comparePaths(0.1, 0.4)) << "standing";
}

TEST_F(SlamProgramTest, LabelsAreNotGivenForTwoPasses)
{
  a_.passes = 2;
  a_.assignments = {"dyseg.labels=" + folder_.file("other")};
  const std::string error = errorOfRun();
  EXPECT_TRUE(contains(error, "dyseg.labels=" + folder_.file("other"))) << error;
  EXPECT_TRUE(contains(error, "--passes 2")) << error;
  EXPECT_TRUE(runs_.empty());
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

TEST_F(SlamProgramTest, TheWallTimeOfAScanIsPrinted)
{
  report_.ms_per_scan = 60;
  report_.run_time = 0.1;
  EXPECT_TRUE(
      contains(printedByRun(), "60.0 ms per scan, all stages added up; 50.0 ms of wall time"));
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
  EXPECT_TRUE(contains(printed, "; 50.0 ms of wall time, as stages run in parallel")) << printed;
}

TEST_F(SlamProgramTest, OneScanIsNamedAsOne)
{
  report_.unconverged = 1;
  EXPECT_TRUE(contains(printedByRun(), "1 scan could not be registered; its motion is predicted"));
  report_.unconverged = 2;
  EXPECT_TRUE(
      contains(printedByRun(), "2 scans could not be registered; their motion is predicted"));
}

/** The folder as a kill during the run with these settings leaves it, but with labels. */
void killInto(const std::string& output, const std::string& labels)
{
  SlamRunSettings settings;
  settings.rawlog = campus;
  settings.output_folder = output;
  settings.labels = true;
  settings.config =
      Config::fromFile(std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/vlp16.ini");
  settings.config.set("dyseg.labels=" + labels);
  settings.config.set("input.only_first_n=3");
  settings.config.set("output.checkpoint_seconds=1e-6");
  const std::string file = output + "/resume.state";
  std::string state;
  (void)runSlam(settings,
                [&](double, std::size_t scans)
                {
                  while (scans == 2 && !fs::exists(file))
                  {
                    std::this_thread::sleep_for(std::chrono::milliseconds(1));
                  }
                  state = scans == 2 ? readWhole(file) : state;
                });
  std::ofstream(file, std::ios::binary) << state;
}

TEST_F(SlamProgramTest, OnlyASecondPassIsResumedAsOne)
{
  a_.resume = true;
  a_.passes = 2;
  const std::string output = folder_.file("run");
  killInto(output, "");
  const std::string labels = keepLabelsOfFirstPass(output);
  EXPECT_EQ("", labelsIn(settingsOfCheckpoint(output)));
  const std::string error = errorOfRun();
  EXPECT_TRUE(contains(error, "the run to resume has no first pass")) << error;
  EXPECT_TRUE(runs_.empty()) << "the labels there are of an earlier run";
  killInto(output, labels);
  EXPECT_EQ("none", errorOfRun());
  EXPECT_EQ(1U, runs_.size());
}
}  // namespace
}  // namespace dyslam
