// SPDX-License-Identifier: BSD-3-Clause
// A run in one pass or two: when it stops, what it refuses, what the second pass has of the first.
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/run/RunSlam.h>
#include <dyslam/run/TwoPassRun.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "../src/FirstPass.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
const std::string campus = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";

class TwoPassRun : public ::testing::Test
{
 protected:
  TwoPassRun()
  {
    request_.settings.rawlog = campus;
    request_.settings.output_folder = folder_.file("run");
    request_.settings.stop = [this] { return is_stopped_; };
    request_.settings.warn = [this](const std::string& warning) { warned_.push_back(warning); };
    request_.assignments = {"input.only_first_n=2"};
    report_.path_length = 100;
  }

  /** Does nothing but labels. */
  PassRunner runner()
  {
    return [this](Pass pass, const SlamRunSettings& settings, const RunSettings* chosen)
    {
      passes_.push_back(pass);
      runs_.push_back(settings);
      EXPECT_EQ(pass == Pass::resumed, chosen == nullptr);
      fs::create_directories(settings.output_folder + "/labels");
      std::ofstream(settings.output_folder + "/labels/000000.label") << "0000";
      is_stopped_ = runs_.size() == stopped_in_;  // as by a Ctrl-C while the last files are written
      SlamRunReport report = report_;
      report.path_length += pass == Pass::second ? longer_ : 0;
      report.warnings.insert(report.warnings.begin(), settings.warnings.begin(),
                             settings.warnings.end());
      if (!report.ended_early.empty())
      {
        report.warnings.insert(report.warnings.begin(), "not complete: " + report.ended_early);
      }
      return report;
    };
  }
  PassesReport run() { return runInPasses(request_, runner()); }
  std::string errorOfRun()
  {
    return messageOfError<UserError>([this] { (void)run(); });
  }

  TestFolder folder_;
  RunRequest request_;
  SlamRunReport report_;
  std::size_t stopped_in_ = 0;  //!< number of the run
  bool is_stopped_ = false;
  double longer_ = 0;  //!< path of the second pass [m]
  std::vector<Pass> passes_;
  std::vector<SlamRunSettings> runs_;
  std::vector<std::string> warned_;
};

TEST_F(TwoPassRun, EachPassHasItsSettings)
{
  request_.passes = 2;
  request_.settings.static_scans = true;
  request_.settings.profile_csv = "times.csv";
  report_.run_time = 3;
  EXPECT_EQ(Pass::second, run().pass);
  ASSERT_EQ((std::vector<Pass>{Pass::first, Pass::second}), passes_);
  EXPECT_TRUE(runs_[0].labels);
  EXPECT_FALSE(runs_[0].static_scans);
  EXPECT_EQ("", runs_[0].profile_csv);
  EXPECT_EQ("false", runs_[0].config.text("pipeline", "mapping"));
  EXPECT_EQ("", labelsIn(runs_[0].config));
  EXPECT_FALSE(runs_[1].labels);
  EXPECT_TRUE(runs_[1].static_scans);
  EXPECT_EQ("times.csv", runs_[1].profile_csv);
  EXPECT_FALSE(runs_[1].config.has("pipeline", "mapping"));
  EXPECT_EQ(folder_.file("run/first_pass/labels"), labelsIn(runs_[1].config));
  EXPECT_EQ(3, runs_[1].first_pass_time);
  EXPECT_EQ(runs_[0].sensor, runs_[1].sensor);
}

TEST_F(TwoPassRun, TheLabelsOfTheFirstPassHaveAnAbsolutePath)
{
  const WorkingFolder within(folder_.path());
  request_.passes = 2;
  request_.settings.output_folder = "run";
  EXPECT_EQ(Pass::second, run().pass);
  ASSERT_EQ(2U, runs_.size());
  EXPECT_EQ((fs::current_path() / "run" / "first_pass" / "labels").string(),
            labelsIn(runs_[1].config));
}

TEST_F(TwoPassRun, FilesOfTheUserAmongTheLabelsStayThere)
{
  folder_.write("run/labels/notes.txt", "mine");
  request_.passes = 2;
  EXPECT_EQ(Pass::second, run().pass);
  EXPECT_EQ("mine", folder_.read("run/labels/notes.txt"));
  EXPECT_EQ("0000", folder_.read("run/first_pass/labels/000000.label"));
}

TEST_F(TwoPassRun, TheOnlyPassHasTheSettingsOfTheRequest)
{
  request_.settings.probabilities = true;
  EXPECT_EQ(Pass::only, run().pass);
  ASSERT_EQ(1U, runs_.size());
  EXPECT_TRUE(runs_[0].probabilities);
  EXPECT_EQ("2", runs_[0].config.text("input", "only_first_n"));
  EXPECT_EQ(0U, runs_[0].sensor.rfind("16 rings", 0)) << runs_[0].sensor;
}

TEST_F(TwoPassRun, AnIniIsAnInputOfEachPass)
{
  request_.passes = 2;
  request_.config = folder_.write("my.ini", "[odometry]\nmethod = gicp\n");
  (void)run();
  ASSERT_EQ(2U, runs_.size());
  for (const SlamRunSettings& settings : runs_)
  {
    EXPECT_EQ(request_.config, settings.ini);
  }
}

TEST_F(TwoPassRun, StoppedWhileItStartsItRunsNothing)
{
  for (const int passes : {1, 2})
  {
    request_.passes = passes;
    is_stopped_ = true;
    EXPECT_EQ(errorOfRun(), campus + ": stopped before the first scan");
    EXPECT_TRUE(runs_.empty());
    EXPECT_FALSE(fs::exists(folder_.file("run")));
  }
}

TEST_F(TwoPassRun, StoppedAtTheEndOfTheFirstPassItRunsNoSecond)
{
  request_.passes = 2;
  stopped_in_ = 1;
  const std::string error = errorOfRun();
  EXPECT_TRUE(contains(error, ": stopped after the first pass")) << error;
  EXPECT_EQ(1U, runs_.size());
  EXPECT_TRUE(fs::exists(folder_.file("run/labels/000000.label")));
}

TEST_F(TwoPassRun, StoppedAtTheEndOfTheOnlyPassItHasEnded)
{
  stopped_in_ = 1;
  EXPECT_NO_THROW((void)run());
}

TEST_F(TwoPassRun, TheSecondPassHasTheWarningsOfTheFirst)
{
  request_.passes = 2;
  report_.second_pass_advice = "17 % of the points move";
  report_.warnings = {"the clock was set", report_.second_pass_advice};
  const PassesReport result = run();
  ASSERT_EQ(2U, runs_.size());
  EXPECT_EQ(std::vector<std::string>{"first pass: the clock was set"}, runs_[1].warnings);
  EXPECT_EQ(runs_[1].warnings, warned_);
  EXPECT_EQ(report_.warnings, result.new_warnings);
}

TEST_F(TwoPassRun, TheWarningOfAnIncompleteRunIsNewAlthoughItIsTheFirst)
{
  request_.settings.warnings = {"a scan of the recording is left out"};
  report_.ended_early = "the recording is damaged";
  report_.warnings = {"the clock was set"};
  EXPECT_EQ(run().new_warnings, (std::vector<std::string>{"not complete: the recording is damaged",
                                                          "the clock was set"}));
}

TEST_F(TwoPassRun, AFirstPassThatFailedEndsIt)
{
  request_.passes = 2;
  report_.failure = "2 of 2 scans could not be registered";
  const PassesReport result = run();
  EXPECT_EQ(Pass::first, result.pass);
  EXPECT_EQ("first pass: " + report_.failure, result.report.failure);
  EXPECT_EQ(1U, runs_.size());
}

TEST_F(TwoPassRun, PathsOfDifferentLengthsAreAWarning)
{
  request_.passes = 2;
  longer_ = 12;
  const PassesReport result = run();
  ASSERT_EQ(1U, result.new_warnings.size());
  EXPECT_EQ(0U, result.new_warnings[0].rfind(
                    "the path is 112.0 m long, that of the first pass 100.0 m", 0));
  EXPECT_EQ(result.new_warnings, result.report.warnings);
  EXPECT_EQ("", comparePaths(100, 109));
  EXPECT_NE("", comparePaths(100, 80));
  EXPECT_EQ("", comparePaths(0.1, 0.4)) << "standing";
}

TEST_F(TwoPassRun, LabelsAreNotGivenForTwoPasses)
{
  request_.passes = 2;
  request_.assignments = {"dyseg.labels=" + folder_.file("other")};
  const std::string error = errorOfRun();
  EXPECT_TRUE(contains(error, "dyseg.labels=" + folder_.file("other"))) << error;
  EXPECT_TRUE(contains(error, "--passes 2")) << error;
  EXPECT_TRUE(runs_.empty());
}

/** Of a run that has and writes labels. */
SlamRunSettings settingsWith(const std::string& output, const std::string& labels)
{
  SlamRunSettings settings;
  settings.rawlog = campus;
  settings.output_folder = output;
  settings.labels = true;
  settings.config =
      Config::fromFile(std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/vlp16.ini");
  settings.config.set("dyseg.labels=" + labels);
  settings.config.set("input.only_first_n=20");
  return settings;
}

/** The folder as a kill during the run with these settings leaves it, but with labels. */
void killInto(const std::string& output, const std::string& labels)
{
  SlamRunSettings settings = settingsWith(output, labels);
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

TEST_F(TwoPassRun, OnlyASecondPassIsResumedAsOne)
{
  request_.resume = true;
  request_.passes = 2;
  const std::string output = folder_.file("run");
  killInto(output, "");
  const std::string labels = keepLabelsOfFirstPass(output);
  EXPECT_EQ("", labelsIn(settingsOfCheckpoint(output)));
  const std::string error = errorOfRun();
  EXPECT_TRUE(contains(error, "the run to resume has no first pass")) << error;
  EXPECT_TRUE(runs_.empty()) << "the labels there are of an earlier run";
  killInto(output, labels);
  EXPECT_EQ(Pass::resumed, run().pass);
  EXPECT_EQ(1U, runs_.size());

  request_.resume = false;
  EXPECT_TRUE(contains(errorOfRun(), "has the checkpoint of an unfinished run"));
  request_.settings.force = true;
  request_.passes = 1;
  EXPECT_EQ(Pass::only, run().pass);
}

TEST_F(TwoPassRun, ASecondPassIsResumedInAnotherFolderAndAfterItWasMoved)
{
  std::size_t scans = 0;
  {
    const WorkingFolder within(folder_.path());
    scans = runSlam(settingsWith("run", "")).frames;
    EXPECT_TRUE(fs::path(keepLabelsOfFirstPass("run")).is_absolute());
    SlamRunSettings second = settingsWith("run", "run/first_pass/labels");
    std::size_t done = 0;
    second.stop = [&] { return done >= 2; };
    EXPECT_THROW((void)runSlam(second, [&](double, std::size_t frames) { done = frames; }),
                 UserError);
    ASSERT_LT(done, scans);
  }
  const std::string moved = folder_.file("moved");
  const std::string labels = moved + "/first_pass/labels";
  fs::rename(folder_.file("run"), moved);
  EXPECT_EQ(labels, labelsIn(settingsOfCheckpoint(moved)));
  EXPECT_TRUE(isSecondPass(settingsOfCheckpoint(moved), moved));

  SlamRunSettings resumed;
  resumed.output_folder = moved;
  folder_.write("other/000000.label", "0000");
  resumed.config.set("dyseg.labels=" + folder_.file("other"));
  EXPECT_EQ(0U, messageOfError<UserError>([&] { (void)resumeSlam(resumed); })
                    .rfind("dyseg.labels is " + folder_.file("other") +
                               ", in the run to resume it is " + labels,
                           0));
  const WorkingFolder within(moved);
  resumed.config.set("dyseg.labels=first_pass/labels");
  EXPECT_EQ(scans, resumeSlam(resumed).frames);
  EXPECT_EQ(labels, labelsIn(Config::fromFile(moved + "/effective.ini")));
}
}  // namespace
}  // namespace dyslam
