// SPDX-License-Identifier: BSD-3-Clause
// Ctrl-C during a conversion: a word, and nothing half-written.
#include <dyslam/formats/ScanFiles.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "RunProgram.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** Starts the program with its stderr in a file, interrupts it once `begun` exists. */
int interrupted(const std::vector<std::string>& words,
                const std::string& err,
                const fs::path& begun)
{
  const pid_t child = ::fork();
  if (child == 0)
  {
    (void)!std::freopen(err.c_str(), "w", stderr);
    std::vector<char*> arguments;
    for (const std::string& word : words)
    {
      arguments.push_back(const_cast<char*>(word.c_str()));
    }
    arguments.push_back(nullptr);
    ::execv(words[0].c_str(), arguments.data());
    ::_exit(99);
  }
  using std::chrono::milliseconds;
  for (int i = 0; i < 3000 && !fs::exists(begun); ++i)
  {
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_TRUE(fs::exists(begun));
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
}  // namespace

TEST(Interrupt, AConversionSaysAWordAndLeavesNothing)
{
  const TestFolder folder;
  // Many names of one scan: it takes longer than a test waits.
  fs::create_directories(folder.file("in"));
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 20000; ++i)
  {
    points.emplace_back(std::sin(0.37F * static_cast<float>(i)) * 40, static_cast<float>(i % 91),
                        1);
  }
  writeBin(folder.file("scan.bin"), points);
  for (int i = 0; i < 20000; ++i)
  {
    fs::create_hard_link(folder.file("scan.bin"), folder.file("in/" + std::to_string(i) + ".bin"));
  }
  folder.write("x.rawlog", "an earlier one");
  const std::string bin = DYSLAM_BIN_DIR;
  const int code = interrupted({bin + "/scans2rawlog", "-q", "--force", "-i", folder.file("in"),
                                "-o", folder.file("x.rawlog")},
                               folder.file("err.txt"), folder.file("x.rawlog.tmp"));
  const std::string said = folder.read("err.txt");
  EXPECT_EQ(1, code) << said;
  EXPECT_TRUE(contains(said, "scans2rawlog: stopped after")) << said;
  EXPECT_TRUE(contains(said, "x.rawlog was not written")) << said;
  EXPECT_FALSE(fs::exists(folder.file("x.rawlog.tmp")));
  EXPECT_EQ("an earlier one", folder.read("x.rawlog"));
}
}  // namespace dyslam
