// SPDX-License-Identifier: BSD-3-Clause
// Interrupts a program as Ctrl-C does.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace dyslam
{
/** Starts the program with its stderr in a file, interrupts it once `hasBegun`. \return exit code;
 * 128 + n if signal n ended it */
inline int interrupted(const std::vector<std::string>& words,
                       const std::string& err,
                       const std::function<bool()>& hasBegun)
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
  for (int i = 0; i < 3000 && !hasBegun(); ++i)
  {
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_TRUE(hasBegun());
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/** Interrupts the program once the file `begun` exists. */
inline int interrupted(const std::vector<std::string>& words,
                       const std::string& err,
                       const std::string& begun)
{
  return interrupted(words, err, [&begun] { return std::filesystem::exists(begun); });
}
}  // namespace dyslam
