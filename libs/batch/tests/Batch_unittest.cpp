// SPDX-License-Identifier: BSD-3-Clause
// A batch that runs a shell script in place of dyslam.
#include <dyslam/base/Error.h>
#include <dyslam/batch/Batch.h>
#include <dyslam/batch/ChildProcess.h>
#include <dyslam/batch/MemoryBudget.h>
#include <dyslam/batch/Summary.h>
#include <dyslam/formats/ProgramLines.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "../src/OneRun.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
/** Script in place of dyslam: `$2` is the recording, `$4` the output folder; each run appends a
 * line to runs.txt. */
class Batch : public testing::Test
{
 protected:
  Batch()
  {
    program("echo 1");
    settings_.output = folder_.file("out");
    settings_.program = folder_.file("dyslam");
    settings_.memory = std::uint64_t{64} << 30U;
    settings_.jobs = 2;
    for (const char* name : {"a", "b", "c"})
    {
      names_.push_back(folder_.write(std::string("in/") + name + ".rawlog", name));
    }
  }

  void program(const std::string& body)
  {
    const std::string path = folder_.write(
        "dyslam", "#!/bin/bash\necho \"$(basename $2)\" >> '" + folder_.file("runs.txt") + "'\n" +
                      body + "\n" +
                      "echo '[output]' > \"$4/effective.ini\"; echo '{}' > \"$4/report.json\"\n");
    fs::permissions(path, fs::perms::owner_all);
  }

  std::vector<BatchResult> run() { return runBatch(settings_, listRecordings(names_), watch_); }

  std::size_t runs() const
  {
    const std::string lines = folder_.read("runs.txt");
    return static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n'));
  }

  TestFolder folder_;
  BatchSettings settings_;
  BatchWatch watch_;
  std::vector<std::string> names_;
};
}  // namespace

TEST_F(Batch, KilledRunsAreResumed)
{
  program(
      "if [[ $5 == --resume ]]; then echo resumed > \"$4/how\"; rm \"$4/resume.state\"\n"
      "elif [[ $2 == */c.rawlog ]]; then touch \"$4/resume.state\"; kill -9 $$; fi");
  const auto results = run();
  EXPECT_EQ(countsOf(results).done, 3U);
  EXPECT_EQ(runs(), 4U);
  EXPECT_EQ(folder_.read("out/c/how"), "resumed\n");
}

TEST_F(Batch, ProgressDoesNotGoBack)
{
  program(
      "echo \"dyslam:  60% 6 scans, 9.0/s, 0:01 left\" >&2; sleep 0.5\n"
      "echo \"dyslam:  10% 1 scan, 9.0/s, 0:01 left\" >&2; sleep 0.5");
  names_.resize(1);
  std::vector<double> shares;
  watch_.progress = [&shares](double share, std::size_t) { shares.push_back(share); };
  EXPECT_EQ(countsOf(run()).done, 1U);
  ASSERT_GT(shares.size(), 2U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.back(), 0.2);
}

TEST_F(Batch, ARecordingOfARunIsNotWrittenTo)
{
  names_ = {folder_.write("out/a/recording.rawlog", "scans")};
  const auto message = messageOfError<UserError>([this] { (void)run(); });
  EXPECT_TRUE(contains(message, "out/a; choose another --output")) << message;
  EXPECT_EQ(folder_.read("out/a/recording.rawlog"), "scans");
  settings_.output = folder_.file("other");
  EXPECT_EQ(countsOf(run()).done, 1U);
  EXPECT_TRUE(fs::exists(folder_.file("other/a/report.json")));
}

TEST(ShareOfRun, ConversionAndPassesAreParts)
{
  const TestFolder folder;
  fs::create_directories(folder.file("scans"));
  folder.write("scans/000000.bin", std::string(16, '\0'));
  const auto share = [&folder](const std::string& title, double fraction, bool is_rawlog,
                               const std::vector<std::string>& arguments)
  {
    const std::string log = folder.write(
        "log.txt", "attempt 1\n" + title + ": " + progressText(fraction, 9, "scans", 2) + "\n");
    return shareOfRun(log, folder.file(is_rawlog ? "x.rawlog" : "scans"), arguments);
  };
  const std::vector<std::string> two{"--labels", "--passes", "2"};
  EXPECT_NEAR(share("dyslam", 0.4, true, {}), 0.4, 1e-9);
  EXPECT_NEAR(share("dyslam, first pass", 1, true, two), 0.5, 1e-9);
  EXPECT_NEAR(share("dyslam", 0.5, true, two), 0.75, 1e-9);
  double last = 0;
  for (const auto& [title, fraction] :
       std::vector<std::pair<std::string, double>>{{"dyslam, unpacking", 0.99},
                                                   {"dyslam, conversion", 0.1},
                                                   {"dyslam, conversion", 0.99},
                                                   {"dyslam, first pass", 0.08},
                                                   {"dyslam, first pass", 0.99},
                                                   {"dyslam", 0.08},
                                                   {"dyslam", 0.99}})
  {
    const double now = share(title, fraction, false, two);
    EXPECT_GT(now, last) << title << ' ' << fraction;
    last = now;
  }
  EXPECT_LE(last, 1);
  folder.write("log.txt", "attempt 1\n");
  EXPECT_EQ(shareOfRun(folder.file("log.txt"), folder.file("scans"), two), 0);
}

TEST_F(Batch, RunsThatCannotBeResumedBeginAnew)
{
  program(
      "if [[ $5 == --resume ]]; then echo 'dyslam: is damaged' >&2; exit 1\n"
      "elif [[ $2 == */c.rawlog && ! -e \"$4/tried\" ]]; then\n"
      "touch \"$4/resume.state\" \"$4/tried\"; kill -9 $$; fi");
  settings_.attempts = 3;
  const auto results = run();
  EXPECT_EQ(countsOf(results).done, 3U);
  EXPECT_EQ(runs(), 5U);
}

/** The new run is killed before it has replaced the checkpoint of the earlier one. */
TEST_F(Batch, CheckpointsOfOtherSettingsAreNotResumed)
{
  settings_.attempts = 1;
  names_ = {names_[2]};
  program("touch \"$4/resume.state\"; kill -9 $$");
  EXPECT_EQ(toText(countsOf(run())), "0 done, 1 failed");
  settings_.common.settings += "--labels ";
  program("kill -9 $$");
  EXPECT_EQ(toText(countsOf(run())), "0 done, 1 failed");
  program("if [[ $5 == --resume ]]; then echo resumed > \"$4/how\"; fi");
  EXPECT_EQ(toText(countsOf(run())), "1 done");
  EXPECT_FALSE(fs::exists(folder_.file("out/c/how")));
}

TEST_F(Batch, RunsWithoutRoomForResultsAreNotRepeatedButCompletedByTheNextBatch)
{
  program(
      "if [[ $5 == --resume ]]; then echo resumed > \"$4/how\"; rm \"$4/resume.state\"\n"
      "else touch \"$4/resume.state\"\n"
      "echo \"dyslam: map.png: cannot be written: No space left on device; " +
      completeLaterAdvice("$4") + "\" >&2; exit 1; fi");
  names_ = {names_[2]};
  EXPECT_EQ(toText(countsOf(run())), "0 done, 1 failed");
  EXPECT_EQ(runs(), 1U);
  EXPECT_EQ(toText(countsOf(run())), "1 done");
  EXPECT_EQ(folder_.read("out/c/how"), "resumed\n");
}

TEST_F(Batch, RunsThatAreStoppedAloneAreNotRepeatedButResumedByTheNextBatch)
{
  const std::string on_resume =
      "if [[ $5 == --resume ]]; then echo resumed > \"$4/how\"; rm \"$4/resume.state\"\n"
      "elif [[ $2 == */c.rawlog ]]; then touch \"$4/resume.state\"; ";
  for (const std::string end :
       {"echo \"dyslam: $2: stopped on request after 3 scans, whose results "
        "are in $4\" >&2; exit 1; fi",
        "kill -TERM $$; sleep 60; fi"})
  {
    program(on_resume + end);
    settings_.common.settings += "--labels ";
    const std::size_t before = runs();
    const auto results = run();
    EXPECT_EQ(toText(countsOf(results)), "2 done, 1 failed") << end;
    EXPECT_EQ(results[2].manifest.attempts, 1);
    EXPECT_TRUE(results[2].manifest.interrupted);
    EXPECT_EQ(runs(), before + 3);
    EXPECT_EQ(toText(countsOf(run())), "3 done (2 before)");
    EXPECT_EQ(folder_.read("out/c/how"), "resumed\n");
    fs::remove(folder_.file("out/c/how"));
  }
}

/** A run that reads the rawlog it converted its input to is resumed without that input. */
TEST_F(Batch, ConvertedRecordingsAreResumed)
{
  program(
      "if [[ $1 == -o ]]; then [[ $3 == --resume ]] && rm \"$2/resume.state\"\n"
      "echo resumed > \"$2/how\"; echo > \"$2/effective.ini\"; echo '{}' > \"$2/report.json\"\n"
      "exit 0; fi\n"
      "touch \"$4/resume.state\"\n"
      "echo \"dyslam: $4/recording.rawlog: stopped on request after 3 scans\" >&2; exit 1");
  names_ = {folder_.write("in/drive.bag", "x")};
  EXPECT_EQ(toText(countsOf(run())), "0 done, 1 failed");
  EXPECT_EQ(toText(countsOf(run())), "1 done");
  EXPECT_EQ(folder_.read("out/drive/how"), "resumed\n");
}

TEST_F(Batch, RunsThatAreStoppedWhileTheyConvertAreNotRepeatedButRunByTheNextBatch)
{
  program(
      "if [[ ! -e \"$4/tried\" ]]; then touch \"$4/tried\"\n"
      "echo \"dyslam: $2: stopped after 3 scans; x was not written\" >&2; exit 1; fi");
  names_ = {folder_.write("in/drive.bag", "x")};
  EXPECT_EQ(toText(countsOf(run())), "0 done, 1 failed");
  EXPECT_EQ(toText(countsOf(run())), "1 done");
}

TEST_F(Batch, OnlyConvertedRecordingsGetTheArgumentsOfTheConversion)
{
  program("echo \"${@:5}\" > \"$4/arguments\"");
  settings_.arguments = {"--labels"};
  settings_.conversion = {"--dt=0.2"};
  names_ = {names_[0], folder_.write("in/drive.pcap", "x")};
  EXPECT_EQ(toText(countsOf(run())), "2 done");
  EXPECT_EQ(folder_.read("out/a/arguments"), "--force --labels\n");
  EXPECT_EQ(folder_.read("out/drive/arguments"), "--force --labels --dt=0.2\n");
  settings_.conversion = {"--dt=0.1"};
  EXPECT_EQ(toText(countsOf(run())), "2 done (1 before)");
  EXPECT_EQ(folder_.read("out/drive/arguments"), "--force --labels --dt=0.1\n");
}

TEST_F(Batch, ASignalToAllOfThemLeavesRunsToBeResumed)
{
  names_ = {names_[2]};
  const std::string asked = folder_.file("asked");
  program(
      "if [[ $5 == --resume ]]; then echo resumed > \"$4/how\"\n"
      "else touch \"$4/resume.state\" '" +
      asked + "'; echo \"dyslam: $2: stopped on request after 3 scans\" >&2; exit 1; fi");
  watch_.stop = [&asked] { return fs::exists(asked); };
  EXPECT_EQ(toText(countsOf(run())), "0 done, 1 not run to the end");
  EXPECT_EQ(readBatch(settings_, listRecordings(names_))[0].manifest.state, State::running);
  watch_ = {};
  EXPECT_EQ(toText(countsOf(run())), "1 done");
  EXPECT_EQ(folder_.read("out/c/how"), "resumed\n");
}

TEST_F(Batch, RunsEachOnceAndSkipsItTheNextTime)
{
  EXPECT_EQ(countsOf(run()).done, 3U);
  EXPECT_EQ(runs(), 3U);
  const auto again = run();
  EXPECT_EQ(runs(), 3U);
  EXPECT_EQ(toText(countsOf(again)), "3 done (3 before)");
  folder_.write("in/b.rawlog", "changed");
  run();
  EXPECT_EQ(runs(), 4U);
  settings_.common.settings = "--labels";
  run();
  EXPECT_EQ(runs(), 7U);
}

TEST_F(Batch, KeepsGoingAndRunsOnceMoreWhatFailed)
{
  program(
      "if [[ $2 == */b.rawlog ]]; then echo 'dyslam: no scans' >&2; exit 1; fi\n"
      "if [[ $2 == */c.rawlog && ! -e \"$4/tried\" ]]; then touch \"$4/tried\"; kill -9 $$; fi");
  const auto results = run();
  EXPECT_EQ(runs(), 5U);
  EXPECT_EQ(results[0].manifest.attempts, 1);
  EXPECT_EQ(results[1].manifest.state, State::failed);
  EXPECT_EQ(results[1].manifest.reason, "dyslam: no scans");
  EXPECT_EQ(results[2].manifest.state, State::done);
  EXPECT_EQ(results[2].manifest.attempts, 2);
  const auto read = readBatch(settings_, listRecordings(names_));
  EXPECT_EQ(read[1].manifest.state, State::failed);
  EXPECT_EQ(read[2].manifest.state, State::done);
}

TEST_F(Batch, ManifestThatCannotBeWrittenIsAFailureOfItsRunAlone)
{
  program("[[ $2 == */b.rawlog ]] && { rm \"$4/manifest.json\"; mkdir \"$4/manifest.json\"; }");
  const auto results = run();
  EXPECT_EQ(toText(countsOf(results)), "2 done, 1 failed");
  EXPECT_EQ(runs(), 3U);
  const std::string& reason = results[1].manifest.reason;
  EXPECT_TRUE(contains(reason, "out/b/manifest.json: is a folder")) << reason;
  EXPECT_EQ(reason.find("manifest.json"), reason.rfind("manifest.json")) << "said once: " << reason;
}

TEST_F(Batch, FailureNamesItsCauseAndTheManifestThatCannotBeWritten)
{
  settings_.scratch = folder_.file("scratch");
  folder_.write("out/b/log.txt", "of an earlier batch");
  folder_.write("out/b/manifest.json/file", "");
  folder_.write("scratch/b/drive.bin", "mine");
  const auto results = run();
  EXPECT_EQ(toText(countsOf(results)), "2 done, 1 failed");
  const std::string& reason = results[1].manifest.reason;
  EXPECT_TRUE(contains(reason, "choose another --scratch; ")) << reason;
  EXPECT_TRUE(contains(reason, "out/b/manifest.json: is a folder")) << reason;
}

TEST_F(Batch, SettingsThatAreRefusedEndItAtOnce)
{
  for (int i = 0; i < 20; ++i)
  {
    names_.push_back(folder_.write("in/" + std::to_string(i) + ".rawlog", "x"));
  }
  program("echo \"dyslam: --set map.voxel: [map] has no key 'voxel'\" >&2; exit 1");
  const std::string said = messageOfError<UserError>([&] { run(); });
  EXPECT_EQ(said.rfind("--set map.voxel: ", 0), 0U) << said;
  EXPECT_LE(runs(), 2U * 2U) << "two at a time";
  program("echo 'dyslam: my.ini:2: unknown section [mapp]' >&2; exit 1");
  settings_.config = "inis/my.ini";
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { run(); }), "my.ini:2"));
}

TEST_F(Batch, FilesOfSettingsThatAreRefusedEndItAtOnce)
{
  settings_.jobs = 1;
  std::size_t before = 0;
  for (const std::string said :
       {"boxes.file: /data/boxes.txt:1: has 5 fields", "boxes.calib is of the boxes of boxes.file",
        "dyseg_network.weights = nope: no such file", "dylo.weights: x.safetensors: is damaged",
        "prior_map.file: none.pcd: no such file or folder"})
  {
    program("echo 'dyslam: " + said + "' >&2; exit 1");
    EXPECT_EQ(said + " (the same for every recording: nothing more was run)",
              messageOfError<UserError>([&] { run(); }));
    EXPECT_EQ(++before, runs()) << said;
  }
  program("echo 'dyslam: input.sensor_label = front: no such sensor' >&2; exit 1");
  EXPECT_EQ(toText(countsOf(run())), "0 done, 3 failed") << "others may have it";
}

TEST_F(Batch, AProgramThatCannotBeRunEndsItAtOnce)
{
  folder_.write("dyslam", "no program");
  fs::permissions(settings_.program, fs::perms::owner_all);
  const std::string said = messageOfError<UserError>([&] { run(); });
  EXPECT_EQ(said.rfind(settings_.program + ": cannot be run: Exec format error", 0), 0U) << said;
  program("echo \"$0: error while loading shared libraries: libx.so\" >&2; exit 127");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { run(); }), "libx.so"));
}

TEST_F(Batch, UselessRunHasResultsAndIsNotRepeated)
{
  program(
      "[[ $2 == */a.rawlog ]] && { echo '[output]' > \"$4/effective.ini\"; echo '{}' > "
      "\"$4/report.json\"; echo 'dyslam: most scans could not be registered' >&2; exit 2; }");
  EXPECT_EQ(run()[0].manifest.state, State::unregistered);
  EXPECT_EQ(toText(countsOf(run())), "2 done, 1 mostly unregistered (3 before)");
  EXPECT_EQ(runs(), 3U);
}

TEST_F(Batch, StoppedItEndsItsRunsAndGoesOnLater)
{
  program("[[ $2 == */a.rawlog ]] && { until [[ -s '" + folder_.file("runs.txt") +
          "' && $(wc -l < '" + folder_.file("runs.txt") +
          "') == 2 ]]; do sleep 0.01; done; }\n[[ $2 == */a.rawlog ]] || sleep 60");
  std::atomic<bool> stop{false};
  watch_.stop = [&stop] { return stop.load(); };
  watch_.ended = [&stop](const BatchResult&, std::size_t) { stop = true; };
  const auto start = std::chrono::steady_clock::now();
  const auto results = run();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  EXPECT_EQ(toText(countsOf(results)), "1 done, 2 not run to the end");
  program("");
  watch_ = {};
  EXPECT_EQ(toText(countsOf(run())), "3 done (1 before)");
}

TEST_F(Batch, ResultsMoveFromScratchAsAWhole)
{
  settings_.scratch = folder_.file("scratch");
  program("[[ $4 == */scratch/* ]] || exit 1; echo x > \"$4/x\"");
  EXPECT_EQ(countsOf(run()).done, 3U);
  EXPECT_EQ(folder_.read("out/b/x"), "x\n");
  EXPECT_TRUE(fs::is_empty(folder_.file("scratch")));
  EXPECT_EQ(countsOf(run()).skipped, 3U);
}

/** Moving a folder to itself would remove it. */
TEST_F(Batch, ScratchMayBeTheFolderOfTheResults)
{
  fs::create_directories(settings_.output);
  fs::create_directory_symlink(settings_.output, folder_.file("link"));
  program("echo x > \"$4/x\"");
  for (const std::string& scratch : {settings_.output + "/.", folder_.file("link")})
  {
    settings_.scratch = scratch;
    settings_.common.settings += "--labels ";
    EXPECT_EQ(countsOf(run()).done, 3U) << scratch;
    EXPECT_EQ(folder_.read("out/b/x"), "x\n") << scratch;
  }
}

TEST_F(Batch, ScratchWithinTheResultsOfARecordingIsRefused)
{
  settings_.scratch = settings_.output + "/b";
  names_ = {names_[1]};
  const auto results = run();
  EXPECT_EQ(results[0].manifest.state, State::failed);
  EXPECT_TRUE(contains(results[0].manifest.reason, "one is within the other"));
}

TEST_F(Batch, ResultsThatCannotBeMovedAreMovedByTheNextBatch)
{
  settings_.scratch = folder_.file("scratch");
  program("echo x > \"$4/x\"; [[ $2 == */b.rawlog ]] && mkfifo \"$4/cannot_be_copied\"");
  EXPECT_EQ(toText(countsOf(run())), "2 done, 1 failed");
  EXPECT_FALSE(fs::exists(folder_.file("out/b.partial"))) << "it would fill the disk";
  EXPECT_EQ(folder_.read("scratch/b/x"), "x\n");
  ASSERT_TRUE(fs::remove(folder_.file("scratch/b/cannot_be_copied")));
  EXPECT_EQ(toText(countsOf(run())), "3 done (2 before)");
  EXPECT_EQ(runs(), 3U);
  EXPECT_EQ(folder_.read("out/b/x"), "x\n");
  EXPECT_TRUE(fs::is_empty(folder_.file("scratch")));
}

TEST_F(Batch, ResultsFromScratchNameTheFilesOfTheirFolder)
{
  settings_.scratch = folder_.file("scratch");
  program(
      "printf '{\n  \"input\": \"%s/recording.rawlog\"\n}\n' \"$4\" > \"$4/report.json\"\n"
      "printf '[dyseg]\nmethod = none\nlabels = %s/first_pass/labels  // of points\n' \"$4\" > "
      "\"$4/effective.ini\"\n"
      "exit 0");
  EXPECT_EQ(countsOf(run()).done, 3U);
  const std::string out = folder_.file("out/b");
  EXPECT_EQ(folder_.read("out/b/report.json"),
            "{\n  \"input\": \"" + out + "/recording.rawlog\"\n}\n");
  EXPECT_EQ(folder_.read("out/b/effective.ini"),
            "[dyseg]\nmethod = none\nlabels = " + out + "/first_pass/labels  // of points\n");
  EXPECT_EQ(countsOf(run()).skipped, 3U);
}

TEST_F(Batch, FailureInScratchLeavesEarlierResultsAndCheckpoints)
{
  settings_.scratch = folder_.file("scratch");
  program("echo 1 > \"$4/x\"");
  run();
  folder_.write("out/c/notes.txt", "mine");
  settings_.common.settings = "--labels";
  program(
      "if [[ $5 == --resume ]]; then echo resumed > \"$4/how\"; rm \"$4/resume.state\"\n"
      "elif [[ $2 == */c.rawlog ]]; then touch \"$4/resume.state\"; kill -9 $$; fi\n"
      "[[ $2 == */a.rawlog ]] && { echo 'dyslam: no scans' >&2; exit 1; }");
  const auto results = run();
  EXPECT_EQ(results[0].manifest.state, State::failed);
  EXPECT_EQ(results[2].manifest.state, State::done);
  EXPECT_EQ(folder_.read("out/a/x"), "1\n");
  EXPECT_TRUE(contains(folder_.read("out/a/log.txt"), "no scans"));
  EXPECT_EQ(folder_.read("out/c/how"), "resumed\n");
  EXPECT_EQ(folder_.read("out/c/notes.txt"), "mine");
  EXPECT_EQ(readBatch(settings_, listRecordings(names_))[0].manifest.state, State::failed);
}

/** What a kill leaves while results are moved: the earlier folder under its other name. */
TEST_F(Batch, FolderOfAnInterruptedMoveIsRestored)
{
  settings_.scratch = folder_.file("scratch");
  program("echo 1 > \"$4/x\"");
  run();
  folder_.write("out/c/notes.txt", "mine");
  fs::rename(folder_.file("out/c"), folder_.file("out/c.earlier"));
  EXPECT_EQ(countsOf(run()).done, 3U);
  EXPECT_EQ(folder_.read("out/c/notes.txt"), "mine");
  EXPECT_FALSE(fs::exists(folder_.file("out/c.earlier")));
}

TEST_F(Batch, ForeignFolderInScratchStaysAsItIs)
{
  settings_.scratch = folder_.file("in");
  folder_.write("in/b/drive.bin", "mine");
  const auto results = run();
  EXPECT_TRUE(contains(results[1].manifest.reason, "--scratch"));
  EXPECT_EQ(folder_.read("in/b/drive.bin"), "mine");
}

TEST_F(Batch, ForeignFoldersStayAsTheyAre)
{
  folder_.write("out/b/thesis.txt", "mine");
  const auto results = run();
  EXPECT_EQ(results[1].manifest.state, State::failed);
  EXPECT_TRUE(contains(results[1].manifest.reason, "no batch wrote"));
  EXPECT_EQ(folder_.read("out/b/thesis.txt"), "mine");
  EXPECT_EQ(countsOf(results).done, 2U);
}

TEST(MemoryBudget, LetsAsManyRunAsFit)
{
  MemoryBudget budget(1000, 400);
  ASSERT_TRUE(budget.fits(false));
  budget.start(false);
  ASSERT_TRUE(budget.fits(false));
  budget.start(false);
  EXPECT_FALSE(budget.fits(false));
  budget.finish(900);
  EXPECT_FALSE(budget.fits(false)) << "one that may take 900 is running";
  budget.finish(100);
  EXPECT_TRUE(budget.fits(true));
  budget.start(true);
  EXPECT_FALSE(budget.fits(false)) << "nothing beside one that is to run alone";
}

TEST(ChildProcess, TellsHowItEnded)
{
  const TestFolder folder;
  const auto outcome = runChild({{"/bin/sh", "-c", "echo said; exit 3"}, folder.file("log"), {}});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(folder.read("log"), "said\n");
  EXPECT_GT(outcome.peak_memory, 100000U);
  EXPECT_EQ(runChild({{"/bin/sh", "-c", "kill -15 $$"}, folder.file("log"), {}}).signal, 15);
}

TEST(IndexPage, LinksReportsAndShowsNamesAsTheyAre)
{
  const TestFolder folder;
  folder.write("a&<b/report.html", "");
  folder.write("a&<b/report.json", "{\"frames\": 17, \"warnings\": [\"w\"]}");
  folder.write("table.json",
               R"({"runs": [{"name": "a&<b", "segmentation": {"iou_moving": 0.5},
                   "trajectory": {"ate": {"translation_m": {"rmse": 0.25}},
                                  "rpe": {"translation_m": {"rmse": 0.125}}}}]})");
  BatchResult r;
  r.recording.name = "a&<b";
  r.manifest.state = State::done;
  const std::string page = indexPage({r}, folder.path(), "body {}");
  EXPECT_TRUE(contains(page, "<a href=\"a%26%3Cb/report.html\">a&amp;&lt;b</a>")) << page;
  EXPECT_TRUE(contains(page, "<p>1 recording, DySLAM</p>")) << page;
  for (const char* figure : {">17</td>", ">0.500</td>", ">0.250</td>", ">0.1250</td>"})
  {
    EXPECT_TRUE(contains(page, figure)) << figure;
  }
  EXPECT_TRUE(contains(page, "1 warning"));
  EXPECT_FALSE(contains(page, "http"));
}

TEST(IndexPage, IsNamedAfterItsFolder)
{
  const TestFolder folder;
  fs::create_directory(folder.file("results"));
  for (const char* name : {"results", "results/"})
  {
    EXPECT_TRUE(contains(indexPage({}, folder.file(name), ""), "<h1>results</h1>")) << name;
  }
}

TEST(IndexPage, ErrorsDoNotDependOnTheNamesInTheTable)
{
  const TestFolder folder;
  const auto run = [](const std::string& name, double ate)
  {
    return R"({"name": ")" + name + R"(", "trajectory": {"ate": {"translation_m": {"rmse": )" +
           std::to_string(ate) + "}}}}";
  };
  folder.write("table.json",
               R"({"runs": [)" + run("x/drive", 0.25) + "," + run("y/drive", 0.5) + "]}");
  std::vector<BatchResult> results(3);
  const std::vector<std::string> names{"drive.1", "drive.2", "drive.3"};
  for (std::size_t i = 0; i < 3; ++i)
  {
    results[i].recording.name = names[i];
    results[i].manifest.state = i == 1 ? State::failed : State::done;
  }
  const std::string page = indexPage(results, folder.path(), "");
  const auto row = [&page](const std::string& name)
  {
    const auto begin = page.find("<td>" + name);
    return page.substr(begin, page.find("</tr>", begin) - begin);
  };
  EXPECT_TRUE(contains(row("drive.1"), ">0.250</td>")) << page;
  EXPECT_FALSE(contains(row("drive.2"), ">0.250</td>")) << page;
  EXPECT_FALSE(contains(row("drive.2"), ">0.500</td>")) << page;
  EXPECT_TRUE(contains(row("drive.3"), ">0.500</td>")) << page;
  results[1].manifest.state = State::done;
  EXPECT_FALSE(contains(indexPage(results, folder.path(), ""), ">0.250</td>"))
      << "a table of other runs";
}
}  // namespace dyslam::batch
