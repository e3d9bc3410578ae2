// SPDX-License-Identifier: BSD-3-Clause
// Runs the programs as a user does.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace dyslam
{
/** Output and exit code of a program; 128 + n if signal n ended it. */
struct Outcome
{
  int code = -1;
  std::string out;
  std::string err;
};

inline std::string contentOf(const std::filesystem::path& path)
{
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/** Runs a program. \param arguments as words of a shell command \param folder folder for files with
 * its output */
inline Outcome runProgram(const std::string& program,
                          const std::string& arguments,
                          const std::string& folder)
{
  const std::string out = folder + "/stdout.txt";
  const std::string err = folder + "/stderr.txt";
  const int status = std::system(
      (std::string(DYSLAM_BIN_DIR) + "/" + program + " " + arguments + " > " + out + " 2> " + err)
          .c_str());
  Outcome outcome;
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = contentOf(out);
  outcome.err = contentOf(err);
  return outcome;
}
}  // namespace dyslam
