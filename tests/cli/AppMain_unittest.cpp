// SPDX-License-Identifier: BSD-3-Clause
#include "../../apps/common/AppMain.h"

#include <dyslam/base/PendingFile.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <string>

#include "FullDisk.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The exit code of a program named `writer` without arguments. */
int exitCodeOf(const std::function<void()>& run)
{
  std::string name = "writer";
  char* arguments[] = {name.data(), nullptr};
  return runApp(
      1, arguments, [](CLI::App&) {}, run);
}

TEST(AppMain, AFileBeyondTheLimitOfTheShellIsAnError)
{
  const TestFolder folder;
  const std::string file = folder.file("a.txt");
  testing::internal::CaptureStderr();  // into a file, of less than the limit
  int code = 0;
  {
    const test::FullDisk disk(10000);
    std::signal(SIGXFSZ, SIG_DFL);  // as in a program that starts
    code = exitCodeOf([&] { writeWhole(file, std::string(20000, 'x')); });
  }
  const std::string error = testing::internal::GetCapturedStderr();
  EXPECT_EQ(1, code);
  EXPECT_EQ(0U, error.find("writer: " + file + ": cannot be written")) << error;
  EXPECT_EQ(error.size() - 1, error.find('\n')) << error;
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(file + ".tmp"));
}
}  // namespace
}  // namespace dyslam
