// SPDX-License-Identifier: BSD-3-Clause
#include "../src/outputs/RunOutputs.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <thread>

#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
const RunOutputKind settings_row = runOutputKinds().front();
const RunOutputKind report_row = runOutputKinds().back();

enum class Failure
{
  none,
  open,
  add,
  finish
};

/** Writes the number of its frames; fails where it is told to. */
class FakeOutput : public RunOutput
{
 public:
  FakeOutput(const RunOutputContext& context, const std::string& name, bool slow, Failure failure)
      : RunOutput(context, {name.c_str()}), name_(name), slow_(slow), failure_(failure)
  {
  }
  [[nodiscard]] OutputThread thread() const override
  {
    return slow_ ? OutputThread::writer : OutputThread::caller;
  }
  void open() override { failIf(Failure::open); }
  void add(const Frame& frame) override
  {
    EXPECT_EQ(frame.index, frames_) << "frames come in order";
    EXPECT_EQ(std::this_thread::get_id() != maker_, slow_) << "the slow ones in a thread of theirs";
    ++frames_;
    if (frames_ == 3)
    {
      failIf(Failure::add);
    }
  }
  void finish(const RunResults& /*results*/) override
  {
    failIf(Failure::finish);
    writeWhole(path(name_), std::to_string(frames_));
  }

 private:
  void failIf(Failure where) const
  {
    if (failure_ == where)
    {
      throw UserError(name_ + ": disk full");
    }
  }

  std::string name_;
  bool slow_;
  Failure failure_;
  std::size_t frames_ = 0;
  std::thread::id maker_ = std::this_thread::get_id();
};

template <Failure failure, bool slow>
std::unique_ptr<RunOutput> makeA(const RunOutputContext& context)
{
  return std::make_unique<FakeOutput>(context, "a.txt", slow, failure);
}

template <bool slow>
std::unique_ptr<RunOutput> makeB(const RunOutputContext& context)
{
  return std::make_unique<FakeOutput>(context, "b.txt", slow, Failure::none);
}

/** Asks for certain frames and writes their numbers, in order. */
template <WantedFrames wanted, OutputThread by_thread>
class RecordingOutput : public RunOutput
{
 public:
  RecordingOutput(const RunOutputContext& context, const char* name)
      : RunOutput(context, {name}), name_(name)
  {
  }
  [[nodiscard]] OutputThread thread() const override { return by_thread; }
  [[nodiscard]] WantedFrames wants() const override { return wanted; }
  void add(const Frame& frame) override { frames_ += std::to_string(frame.index) + " "; }
  void finish(const RunResults& /*results*/) override { writeWhole(path(name_), frames_); }

 private:
  std::string name_;
  std::string frames_;
};

template <WantedFrames wanted, OutputThread by_thread = OutputThread::caller>
std::unique_ptr<RunOutput> makeRecording(const RunOutputContext& context)
{
  constexpr std::array<const char*, 4> names{"causal.txt", "objects.txt", "points.txt",
                                             "scans.txt"};
  return std::make_unique<RecordingOutput<wanted, by_thread>>(
      context, names[static_cast<std::size_t>(wanted)]);
}

/** Changes a numbered file at the end. */
class NumberedOutput : public RunOutput
{
 public:
  explicit NumberedOutput(const RunOutputContext& context)
      : RunOutput(context, {{"numbered", ".txt"}})
  {
  }
  [[nodiscard]] OutputThread thread() const override { return OutputThread::writer; }
  void open() override
  {
    makeFolder(path("numbered"));
    write("open");
  }
  void finish(const RunResults& /*results*/) override { write("finished"); }

 private:
  void write(const std::string& text) const { writeWhole(path("numbered") + "/000000.txt", text); }
};

std::unique_ptr<RunOutput> makeNumbered(const RunOutputContext& context)
{
  return std::make_unique<NumberedOutput>(context);
}

Frame frameOf(std::size_t index)
{
  Frame frame;
  frame.index = index;
  return frame;
}

class RunOutputsTest : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    settings_.rawlog = "x.rawlog";
    settings_.output_folder = folder_.string();
  }

  /** Five frames to these outputs. */
  RunResults runOf(const std::vector<RunOutputKind>& kinds)
  {
    const Config given;
    ConfigLoader config(given);
    RunOutputs outputs(settings_, config, FrameKind::causal, kinds);
    outputs.open();
    for (std::size_t i = 0; i < 5; ++i)
    {
      outputs.add(FrameKind::causal, frameOf(i));
    }
    RunResults results;
    outputs.finish(results);
    return results;
  }

  [[nodiscard]] std::string content(const std::string& name) const
  {
    return readWhole((folder_ / name).string());
  }
  [[nodiscard]] bool has(const std::string& name) const { return fs::exists(folder_ / name); }

  const TestFolder test_;
  const fs::path folder_ = test_.file("run");  //!< made by the outputs
  SlamRunSettings settings_;
};

TEST_F(RunOutputsTest, LargeOutputsEndBeforeTheDiskIsFullTheLeastImportantFirst)
{
  constexpr auto large = OutputThread::writer;
  const std::vector<RunOutputKind> kinds{{makeRecording<WantedFrames::final_scans, large>},
                                         {makeRecording<WantedFrames::causal, large>},
                                         {makeB<false>},
                                         report_row};
  const Config given;
  ConfigLoader config(given);
  std::vector<std::string> warnings;
  settings_.warn = [&warnings](const std::string& warning) { warnings.push_back(warning); };
  std::uintmax_t free = diskReserve(3);  // until the fourth scan
  RunOutputs outputs(settings_, config, FrameKind::causal, kinds,
                     [this, &free](const std::string& folder)
                     {
                       EXPECT_EQ(folder, folder_.string());
                       return has("causal.txt.tmp") ? free : diskReserve(5);
                     });
  outputs.open();
  writeWhole((folder_ / "causal.txt.tmp").string(), "kept for a resumed run");
  for (std::size_t i = 0; i < 5; ++i)
  {
    outputs.add(FrameKind::causal, frameOf(i));
    outputs.add(FrameKind::final, frameOf(i));
  }
  RunResults results;
  outputs.finish(results);
  ASSERT_EQ(results.failures.size(), 1U);
  EXPECT_EQ(results.failures.front().find("causal.txt: ends after 3 scans: the disk has 9 MB"), 0U)
      << results.failures.front();
  EXPECT_FALSE(has("causal.txt"));
  EXPECT_FALSE(has("causal.txt.tmp")) << "its space is needed";
  EXPECT_EQ(content("scans.txt"), "0 1 2 3 4 ");
  EXPECT_EQ(content("b.txt"), "5");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("the run goes on without it"), std::string::npos);
}

TEST_F(RunOutputsTest, EachOutputGetsFramesOfItsKind)
{
  const std::vector<RunOutputKind> kinds{
      {makeRecording<WantedFrames::causal>},
      {makeRecording<WantedFrames::final_objects>},
      {makeRecording<WantedFrames::final_points, OutputThread::writer>},
      {makeRecording<WantedFrames::final_scans, OutputThread::writer>}};
  for (const FrameKind objects : {FrameKind::final, FrameKind::causal})
  {
    fs::remove_all(folder_);
    const Config given;
    ConfigLoader config(given);
    RunOutputs outputs(settings_, config, objects, kinds);
    EXPECT_EQ(outputs.finalParts(), FrameParts::all);
    outputs.open();
    constexpr std::size_t delay = 2;  // of the final frames
    for (std::size_t i = 0; i < 6; ++i)
    {
      outputs.add(FrameKind::causal, frameOf(i));
      if (i >= delay)
      {
        outputs.add(FrameKind::final, frameOf(i - delay));
      }
    }
    RunResults results;
    outputs.finish(results);
    const std::string causal = "0 1 2 3 4 5 ";
    const std::string of_final = "0 1 2 3 ";
    EXPECT_EQ(content("causal.txt"), causal);
    EXPECT_EQ(content("objects.txt"), objects == FrameKind::final ? of_final : causal);
    EXPECT_EQ(content("points.txt"), of_final);
    EXPECT_EQ(content("scans.txt"), of_final);
  }
}

TEST_F(RunOutputsTest, OutputsThatAreSwitchedOffNeedNoFinalFrames)
{
  const auto partsWith = [&](bool static_scans)
  {
    const Config given;
    ConfigLoader config(given);
    settings_.static_scans = static_scans;
    return RunOutputs(settings_, config, FrameKind::causal,
                      {{makeRecording<WantedFrames::final_points>},
                       {makeRecording<WantedFrames::final_scans>, nullptr, nullptr,
                        &SlamRunSettings::static_scans}})
        .finalParts();
  };
  EXPECT_EQ(partsWith(true), FrameParts::all);
  EXPECT_EQ(partsWith(false), FrameParts::none);
}

TEST_F(RunOutputsTest, AnOutputThatFailsGetsNoMoreFrames)
{
  const Config given;
  ConfigLoader config(given);
  GuardedOutput output(makeA<Failure::add, false>({settings_, config, 0.4}));
  output.open();
  std::vector<bool> went_on;
  for (std::size_t i = 0; i < 5; ++i)
  {
    went_on.push_back(output.add(frameOf(i)));
  }
  EXPECT_EQ(went_on, (std::vector<bool>{true, true, false, true, true})) << "tells of it once";
  EXPECT_EQ(output.failure(), "a.txt: disk full");
  EXPECT_TRUE(output.hasFailedSinceState());
  output.finish(RunResults());
  EXPECT_EQ(output.failure(), "a.txt: disk full");
  EXPECT_FALSE(has("a.txt"));
  StateArchive state;
  EXPECT_TRUE(output.exchangeState(state));
  EXPECT_FALSE(output.hasFailedSinceState()) << "a resumed run has no frames for it";
}

TEST_F(RunOutputsTest, WritesWhatDoesNotFailAndNamesWhatDoes)
{
  const std::vector<std::vector<RunOutputKind>> all{
      {{makeA<Failure::add, false>}, {makeB<false>}, report_row},
      {{makeA<Failure::finish, false>}, {makeB<true>}, report_row},
      {{makeA<Failure::add, true>}, {makeB<false>}, report_row},
      {{makeA<Failure::finish, true>}, {makeB<true>}, report_row}};
  std::size_t fail_while_running = 0;
  std::vector<std::string> told;
  settings_.warn = [&told](const std::string& warning) { told.push_back(warning); };
  for (const auto& kinds : all)
  {
    told.clear();
    const RunResults results = runOf(kinds);
    fail_while_running += told.size();
    if (!told.empty())
    {
      EXPECT_EQ(told, std::vector<std::string>{"a.txt: disk full; the run goes on without it"});
    }
    EXPECT_EQ(results.failures, std::vector<std::string>{"a.txt: disk full"});
    EXPECT_EQ(results.report.files, (std::vector<std::string>{"b.txt", "report.json"}));
    EXPECT_FALSE(has("a.txt"));
    EXPECT_EQ(content("b.txt"), "5");
    EXPECT_NE(content("report.json").find("a.txt: disk full"), std::string::npos);
    fs::remove_all(folder_);
  }
  EXPECT_EQ(fail_while_running, 2U);
}

TEST_F(RunOutputsTest, AFileThatCannotBeOpenedEndsTheRunAtOnce)
{
  EXPECT_THROW((void)runOf({{makeA<Failure::open, false>}, {makeB<false>}}), UserError);
}

TEST_F(RunOutputsTest, TheReportListsTheFilesWritten)
{
  const RunResults results = runOf({settings_row, {makeA<Failure::none, true>}, report_row});
  EXPECT_TRUE(results.failures.empty());
  const std::vector<std::string> files{"effective.ini", "a.txt", "report.json"};
  EXPECT_EQ(results.report.files, files);
  for (const std::string& file : files)
  {
    EXPECT_NE(content("report.json").find('"' + file + '"'), std::string::npos) << file;
  }
}

TEST_F(RunOutputsTest, CheckpointsThatFailAreAWarning)
{
  std::vector<std::string> told;
  settings_.warn = [&told](const std::string& warning) { told.push_back(warning); };
  const auto warningsAfter = [this](const std::vector<std::string>& failures)
  {
    const Config given;
    ConfigLoader config(given);
    RunOutputs outputs(settings_, config, FrameKind::causal,
                       {settings_row, {makeB<true>}, report_row});
    outputs.open();
    for (const std::string& failure : failures)
    {
      const auto begin = std::chrono::steady_clock::now();
      bool written = false;
      while (!written && std::chrono::steady_clock::now() - begin < std::chrono::seconds(60))
      {
        // Left out while the one before is being written.
        outputs.checkpoint(
            [&](StateFileWriter&)
            {
              written = true;
              if (!failure.empty())
              {
                throw UserError(failure);
              }
            },
            RunResults());
      }
      EXPECT_TRUE(written);
    }
    RunResults results;
    outputs.finish(results);
    return results.report.warnings;
  };
  const std::string failed = "checkpoints could not be written: disk full; the run can";
  EXPECT_EQ(warningsAfter({"no space", "disk full"}),
            std::vector<std::string>{failed + "not be resumed"});
  EXPECT_EQ(told.size(), 1U) << "once";
  EXPECT_NE(content("report.json").find(failed + "not be resumed"), std::string::npos);
  EXPECT_TRUE(warningsAfter({"disk full", ""}).empty()) << "a later one succeeded";
  EXPECT_EQ(warningsAfter({"", "disk full"}),
            std::vector<std::string>{failed + " be resumed from an earlier one only"});
  EXPECT_EQ(told.size(), 3U);
}

TEST_F(RunOutputsTest, AStateThatCannotBeWrittenIsAWarning)
{
  const Config given;
  ConfigLoader config(given);
  RunOutputs outputs(settings_, config, FrameKind::causal, {report_row});
  outputs.open();
  outputs.checkpoint([this](StateFileWriter&)
                     { fs::create_directories(folder_ / "resume.state" / "in the way"); },
                     RunResults());
  RunResults results;
  outputs.finish(results);
  ASSERT_EQ(results.report.warnings.size(), 1U);
  EXPECT_NE(results.report.warnings[0].find("resume.state"), std::string::npos)
      << results.report.warnings[0];
}

TEST_F(RunOutputsTest, ChangedFilesAreKeptForAResumedRun)
{
  const auto write = [this](const std::string& name, const std::string& text)
  { writeWhole((folder_ / name).string(), text); };
  fs::create_directories(folder_ / "labels");
  write("labels/000000.label", "same");
  write("labels/000001.label", "before");
  KeptFiles kept(folder_.string());
  EXPECT_EQ(kept.add({"labels", ".label"}).name, "resume.labels");
  kept.keep();
  write("labels/000001.label", "changed");
  write("labels/000002.label", "new");
  kept.removeUnchanged();
  EXPECT_FALSE(has("resume.labels/000000.label"));
  EXPECT_EQ(content("resume.labels/000001.label"), "before");
  EXPECT_EQ(content("labels/000001.label"), "changed");
  kept.restore();
  EXPECT_EQ(content("labels/000000.label"), "same");
  EXPECT_EQ(content("labels/000001.label"), "before");
  EXPECT_FALSE(has("resume.labels"));

  kept.keep();  // and ended before anything was removed
  kept.restore();
  EXPECT_EQ(content("labels/000001.label"), "before");
  EXPECT_FALSE(has("resume.labels"));
  kept.keep();
  kept.removeAll();
  EXPECT_FALSE(has("resume.labels"));
}

TEST_F(RunOutputsTest, TheLastCheckpointStaysForAResumedRun)
{
  for (const bool is_last : {false, true})
  {
    const Config given;
    ConfigLoader config(given);
    RunOutputs outputs(settings_, config, FrameKind::causal,
                       {settings_row, {makeB<true>}, report_row});
    outputs.open();
    outputs.checkpoint([](StateFileWriter&) {}, RunResults());
    outputs.checkpoint([](StateFileWriter&) {}, RunResults(), is_last);
    RunResults results;
    results.report.ended_early = is_last ? "stopped" : "";
    outputs.finish(results);
    EXPECT_EQ(has("resume.state"), is_last);
    EXPECT_EQ(content("report.json").find("\"finished\": true") == std::string::npos, is_last);
    EXPECT_TRUE(has("b.txt"));
  }
}

TEST_F(RunOutputsTest, TheStateStaysForWhatFailedAfterIt)
{
  const auto stays = [this](const RunOutputKind& kind, const std::string& ended_early)
  {
    const Config given;
    ConfigLoader config(given);
    RunOutputs outputs(settings_, config, FrameKind::causal, {settings_row, kind, report_row});
    outputs.open();
    for (std::size_t i = 0; i < 5; ++i)
    {
      outputs.add(FrameKind::causal, frameOf(i));
    }
    outputs.checkpoint([](StateFileWriter&) {}, RunResults());
    RunResults results;
    results.report.ended_early = ended_early;
    outputs.finish(results);
    return has("resume.state");
  };
  EXPECT_FALSE(stays({makeA<Failure::none, false>}, ""));
  EXPECT_TRUE(stays({makeA<Failure::finish, false>}, ""));
  EXPECT_FALSE(stays({makeA<Failure::finish, false>}, "damaged")) << "it would end there again";
  EXPECT_FALSE(stays({makeA<Failure::add, false>}, "")) << "it failed before";
  EXPECT_FALSE(stays({makeA<Failure::add, true>}, "")) << "it failed before";
}

TEST_F(RunOutputsTest, WithoutAStateNoFilesAreKept)
{
  for (const bool fails : {false, true})
  {
    const Config given;
    ConfigLoader config(given);
    RunOutputs outputs(settings_, config, FrameKind::causal,
                       {settings_row, {makeNumbered, nullptr, nullptr, nullptr, true}});
    outputs.open();
    const auto add_state = [fails](StateFileWriter& /*state*/)
    {
      if (fails)
      {
        throw UserError("disk full");
      }
    };
    outputs.checkpoint(add_state, RunResults(), true);
    RunResults results;
    outputs.finish(results);
    EXPECT_EQ(content("numbered/000000.txt"), "finished");
    EXPECT_NE(has("resume.state"), fails);
    EXPECT_NE(has("resume.numbered/000000.txt"), fails);
  }
}

TEST_F(RunOutputsTest, WhatIsSwitchedOffIsRemovedAllTheSame)
{
  const std::vector<RunOutputKind> kinds{
      settings_row,
      {makeA<Failure::none, false>},
      {makeB<false>, nullptr, nullptr, &SlamRunSettings::static_scans}};
  settings_.static_scans = true;
  (void)runOf(kinds);
  ASSERT_TRUE(has("b.txt"));
  writeWhole((folder_ / "b.txt.tmp").string(), "of a run that was killed");
  writeWhole((folder_ / "notes.txt").string(), "mine");
  settings_.static_scans = false;
  (void)runOf(kinds);
  EXPECT_TRUE(has("a.txt"));
  EXPECT_FALSE(has("b.txt"));
  EXPECT_FALSE(has("b.txt.tmp"));
  EXPECT_TRUE(has("notes.txt"));
}

TEST_F(RunOutputsTest, EveryKindHasNamesOfItsOwn)
{
  const Config given;
  ConfigLoader config(given);
  std::set<std::string> names;
  for (const RunOutputKind& kind : runOutputKinds())
  {
    const auto output = kind.make({settings_, config, 0.4});
    EXPECT_FALSE(output->names().empty());
    for (const OutputName& name : output->names())
    {
      EXPECT_TRUE(names.insert(name.name).second) << name.name << " is written by two outputs";
    }
  }
  EXPECT_FALSE(fs::exists(folder_)) << "nothing is written before open()";
}
}  // namespace
}  // namespace dyslam
