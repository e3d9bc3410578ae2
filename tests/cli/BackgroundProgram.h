// SPDX-License-Identifier: BSD-3-Clause
// Runs a program beside the test.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "RunProgram.h"

namespace dyslam
{
/** A program that runs until it ends, or the object does. */
class BackgroundProgram
{
 public:
  /** \param words of the command, the first is a program in DYSLAM_BIN_DIR \param out, err files
   * for its output */
  BackgroundProgram(const std::vector<std::string>& words,
                    const std::string& out,
                    const std::string& err)
      : err_(err)
  {
    (void)std::remove(err.c_str());  // what an earlier program said
    child_ = ::fork();
    if (child_ != 0)
    {
      return;
    }
    (void)!std::freopen(out.c_str(), "w", stdout);
    (void)!std::freopen(err.c_str(), "w", stderr);
    const std::string program = std::string(DYSLAM_BIN_DIR) + "/" + words[0];
    std::vector<char*> arguments;
    for (const std::string& word : words)
    {
      arguments.push_back(const_cast<char*>(word.c_str()));
    }
    arguments.push_back(nullptr);
    ::execv(program.c_str(), arguments.data());
    ::_exit(99);
  }
  ~BackgroundProgram()
  {
    if (child_ > 0)
    {
      ::kill(child_, SIGKILL);
      (void)wait();
    }
  }
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  /** Waits until something is so, or the program has ended, a minute at most. */
  bool waitUntil(const std::function<bool()>& isSo)
  {
    for (int i = 0; i < 12000 && !isSo() && isRunning(); ++i)
    {
      ::usleep(5000);
    }
    return isSo();
  }
  /** What it said so far on stderr. */
  [[nodiscard]] std::string said() const { return contentOf(err_); }
  void signal(int number) const { ::kill(child_, number); }
  /** \return exit code; 128 + n if signal n ended it */
  int wait()
  {
    if (child_ > 0)
    {
      ::waitpid(child_, &status_, 0);
      child_ = -1;
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

 private:
  bool isRunning()
  {
    if (child_ > 0 && ::waitpid(child_, &status_, WNOHANG) == child_)
    {
      child_ = -1;
    }
    return child_ > 0;
  }

  std::string err_;
  pid_t child_ = -1;
  int status_ = 0;
};
}  // namespace dyslam
