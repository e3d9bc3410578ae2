// SPDX-License-Identifier: BSD-3-Clause
// dyslam --window: on a screen in memory (Xvfb), where that is installed, and without a screen.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "InterruptProgram.h"
#include "RunProgram.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
const std::string recording = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/street64.rawlog";

/** A screen in memory, of 1300 x 860 pixels of 32 bits; its content is in a file. */
class ScreenInMemory
{
 public:
  /** \param folder for the content of the screen */
  explicit ScreenInMemory(const std::string& folder) : file_(folder + "/Xvfb_screen0")
  {
    int ends[2];
    if (::pipe(ends) != 0)
    {
      return;
    }
    process_ = ::fork();
    if (process_ == 0)
    {
      ::close(ends[0]);
      const std::string number = std::to_string(ends[1]);
      ::execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "1300x860x24",
               "-fbdir", folder.c_str(), "-nolisten", "tcp", static_cast<char*>(nullptr));
      ::_exit(99);
    }
    ::close(ends[1]);
    std::string number;
    char c = 0;
    while (::read(ends[0], &c, 1) == 1 && c != '\n')  // the display, once the screen is there
    {
      number += c;
    }
    ::close(ends[0]);
    if (!number.empty())
    {
      display_ = ":" + number;
    }
  }
  ~ScreenInMemory()
  {
    if (process_ > 0)
    {
      ::kill(process_, SIGTERM);
      ::waitpid(process_, nullptr, 0);
    }
  }
  ScreenInMemory(const ScreenInMemory&) = delete;
  ScreenInMemory& operator=(const ScreenInMemory&) = delete;

  /** Empty if Xvfb is not installed. */
  [[nodiscard]] const std::string& display() const { return display_; }
  [[nodiscard]] std::size_t colours() const
  {
    const std::string content = contentOf(file_);
    std::set<std::string> found;
    for (std::size_t i = 4096; i + 4 <= content.size(); i += 4)
    {
      found.insert(content.substr(i, 4));
    }
    return found.size();
  }

 private:
  std::string file_;
  std::string display_;
  pid_t process_ = -1;
};
}  // namespace

TEST(LiveWindow, ShowsARunAndDoesNotChangeItsResults)
{
  const TestFolder folder;
  const ScreenInMemory screen(folder.path());
  if (screen.display().empty())
  {
    ASSERT_NE(0, std::system("command -v Xvfb > /dev/null")) << "Xvfb does not start";
    GTEST_SKIP() << "Xvfb is not installed";
  }
  ::setenv("DISPLAY", screen.display().c_str(), 1);
  ::unsetenv("WAYLAND_DISPLAY");
  const std::size_t colours_before = screen.colours();
  std::size_t colours = 0;
  const std::string shown = folder.file("shown");
  // The window stays open once all is written; Ctrl-C then ends the program.
  int polls = 0;
  const auto is_written = [&]
  {
    if (++polls % 40 == 0)  // every 0.2 s
    {
      colours = std::max(colours, screen.colours());
    }
    return folder.read("err.txt").find("100%") != std::string::npos;
  };
  const int code = interrupted({std::string(DYSLAM_BIN_DIR) + "/dyslam", "-i", recording, "-o",
                                shown, "--only-first-n", "20", "--window"},
                               folder.file("err.txt"), is_written);
  EXPECT_EQ(0, code) << folder.read("err.txt");
  EXPECT_LT(colours_before, 3U);
  EXPECT_GT(colours, 100U);  // points coloured by height and intensity

  const std::string plain = folder.file("plain");
  ASSERT_EQ(0, runProgram("dyslam", "-i " + recording + " -o " + plain + " --only-first-n 20",
                          folder.path())
                   .code);
  for (const std::string name : {"trajectory_tum.txt", "tracks.csv", "map_static.pcd"})
  {
    EXPECT_EQ(contentOf(plain + "/" + name), contentOf(shown + "/" + name)) << name;
  }
}

TEST(LiveWindow, WithoutADisplayIsAnErrorBeforeTheRun)
{
  const TestFolder folder;
  ::unsetenv("DISPLAY");
  ::unsetenv("WAYLAND_DISPLAY");
  const Outcome outcome = runProgram(
      "dyslam", "-i " + recording + " -o " + folder.file("out") + " --window", folder.path());
  EXPECT_EQ(1, outcome.code);
  EXPECT_NE(std::string::npos, outcome.err.find("--window: there is no display")) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.file("out")));
}
}  // namespace dyslam
