// SPDX-License-Identifier: BSD-3-Clause
// dyslam-batch on the bundled recordings, against single runs.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <thread>

#include "RunProgram.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
const std::string recordings = std::string(DYSLAM_SOURCE_DIR) + "/rawlog";
const std::string settings = " --set dyseg.method=residual --only-first-n 4 --labels ";

std::set<std::string> filesIn(const fs::path& folder)
{
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
  {
    if (entry.is_regular_file())
    {
      files.insert(fs::relative(entry.path(), folder).string());
    }
  }
  return files;
}

/** All files of a run but those that hold times. */
void expectSameBytes(const fs::path& expected, const fs::path& given)
{
  const std::set<std::string> timed{"report.json", "report.html"};
  std::set<std::string> files = filesIn(given);
  for (const char* of_the_batch : {"manifest.json", "log.txt"})
  {
    EXPECT_EQ(files.erase(of_the_batch), 1U) << of_the_batch;
  }
  EXPECT_EQ(files, filesIn(expected));
  for (const std::string& file : files)
  {
    EXPECT_TRUE(timed.count(file) > 0 || contentOf(expected / file) == contentOf(given / file))
        << file;
  }
}
}  // namespace

TEST(Batch, HasTheBytesOfSingleRunsAndSkipsWhatIsDone)
{
  const TestFolder folder;
  folder.write("bad.rawlog", "no scans");
  const std::string command =
      recordings + " " + folder.file("bad.rawlog") + settings + "-o " + folder.file("batch");
  const Outcome first = runProgram("dyslam-batch", command, folder.path());
  EXPECT_EQ(first.code, 2) << first.err;
  EXPECT_TRUE(contains(first.err, "2 done, 1 failed")) << first.err;
  EXPECT_TRUE(contains(first.out, "bad: failed")) << first.out;
  for (const std::string name : {"street64", "campus16"})
  {
    const std::string single = folder.file("single/" + name);
    fs::create_directories(folder.file("single"));
    const Outcome run =
        runProgram("dyslam", "-i " + recordings + "/" + name + ".rawlog -o " + single + settings,
                   folder.path());
    ASSERT_EQ(run.code, 0) << run.err;
    expectSameBytes(single, folder.file("batch/" + name));
    EXPECT_TRUE(contains(folder.read("batch/table.csv"), name));
    EXPECT_TRUE(contains(folder.read("batch/index.html"), "href=\"" + name + "/report.html\""));
  }
  const Outcome again = runProgram(
      "dyslam-batch", recordings + settings + "-o " + folder.file("batch"), folder.path());
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(contains(again.out, "2 done (2 before)")) << again.out;
  // Both recordings have ground truth: none of their figures is missing.
  EXPECT_FALSE(contains(folder.read("batch/index.html"), "<td class=\"number\"></td>"));
}

TEST(Batch, NamesThatDifferBehindADotHaveTheirErrorsOnThePage)
{
  const TestFolder folder;
  for (const std::string name : {"day.1", "day.2"})
  {
    fs::copy(recordings + "/campus16.rawlog", folder.file(name + ".rawlog"));
    fs::copy(recordings + "/campus16.gt", folder.file(name + ".gt"), fs::copy_options::recursive);
  }
  const Outcome batch = runProgram(
      "dyslam-batch", folder.path() + settings + "-o " + folder.file("batch"), folder.path());
  ASSERT_EQ(batch.code, 0) << batch.err;
  const std::string page = folder.read("batch/index.html");
  EXPECT_TRUE(contains(page, "href=\"day.2/report.html\"")) << page;
  EXPECT_FALSE(contains(page, "<td class=\"number\"></td>")) << page;
}

TEST(Batch, ProcessesEachRecordingTwiceIfAsked)
{
  const TestFolder folder;
  const std::string twice = recordings + "/campus16.rawlog" + settings + "--passes 2 -o ";
  const Outcome batch = runProgram("dyslam-batch", twice + folder.file("batch"), folder.path());
  ASSERT_EQ(batch.code, 0) << batch.err;
  const Outcome single = runProgram("dyslam", "-i " + twice + folder.file("single"), folder.path());
  ASSERT_EQ(single.code, 0) << single.err;
  for (const std::string name :
       {"labels/000003.label", "first_pass/labels/000003.label", "trajectory_tum.txt"})
  {
    EXPECT_EQ(folder.read("batch/campus16/" + name), folder.read("single/" + name)) << name;
  }
}

TEST(Batch, AnEditedFileOfTheSettingsMakesNewResults)
{
  const TestFolder folder;
  fs::copy(recordings + "/campus16.gt/tracks.txt", folder.file("boxes.txt"));
  const auto said = [&folder]
  {
    return runProgram("dyslam-batch",
                      recordings + "/campus16.rawlog" + settings + "--no-summary -o " +
                          folder.file("batch") + " --set boxes.file=" + folder.file("boxes.txt"),
                      folder.path())
        .out;
  };
  EXPECT_TRUE(contains(said(), "campus16: done, "));
  EXPECT_TRUE(contains(said(), "campus16: done before"));
  const std::string boxes = folder.read("boxes.txt");
  folder.write("boxes.txt", boxes.substr(boxes.find('\n') + 1));
  EXPECT_TRUE(contains(said(), "campus16: done, "));
}

TEST(Batch, StoppedAndStartedAgainItGoesOn)
{
  const TestFolder folder;
  const std::string program = std::string(DYSLAM_BIN_DIR) + "/dyslam-batch";
  const std::string out = folder.file("batch");
  const pid_t child = ::fork();
  if (child == 0)
  {
    ::execl(program.c_str(), program.c_str(), recordings.c_str(), "-o", out.c_str(), "--jobs", "1",
            "-q", "--set", "dyseg.method=residual", nullptr);
    ::_exit(99);
  }
  for (int i = 0; i < 3000 && !fs::exists(out + "/campus16/log.txt"); ++i)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::kill(child, SIGTERM);
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_TRUE(contains(folder.read("batch/campus16/manifest.json"), "\"running\""));
  EXPECT_FALSE(fs::exists(out + "/street64"));
  const Outcome again =
      runProgram("dyslam-batch", recordings + settings + "-o " + out, folder.path());
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(contains(again.out, "2 done;")) << again.out;
}

TEST(Batch, BadInputIsOneLine)
{
  const TestFolder folder;
  const std::string out = " -o " + folder.file("out");
  const auto said = [&folder](const std::string& command)
  {
    const Outcome outcome = runProgram("dyslam-batch", command, folder.path());
    EXPECT_EQ(outcome.code, 1) << command << outcome.out;
    return outcome.err;
  };
  EXPECT_TRUE(contains(said("none.rawlog" + out), "none.rawlog: no such file"));
  EXPECT_TRUE(contains(said(recordings + out + " --shard 3/2"), "is not K/N"));
  EXPECT_TRUE(contains(said(recordings + out + " -c none.ini"), "none.ini: no such file"));
  EXPECT_TRUE(contains(said(recordings + out + " --set nonsense"), "nonsense"));
  EXPECT_TRUE(contains(said(recordings + out + " --slurm-options --mem=1G"), "--slurm"));
  for (const std::string option : {"--jobs 2", "--memory 8", "--no-summary", "--gather"})
  {
    const std::string line = said(recordings + out + " --slurm " + option);
    EXPECT_TRUE(contains(line, option.substr(0, option.find(' ')) + " excludes --slurm")) << line;
  }
  EXPECT_TRUE(contains(said(recordings + out + " --no-summary --gather"), "excludes"));
  EXPECT_FALSE(fs::exists(folder.file("out")));
}
}  // namespace dyslam
