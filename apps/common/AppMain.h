// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <stdexcept>

namespace dyslam
{
/** The program ended normally, but the result is unusable: exit code 2. */
class UnusableResult : public std::runtime_error
{
 public:
  using std::runtime_error::runtime_error;
};

/** Body of main() of every program.
 *
 * `declare` adds flags to the parser, `run` works. Returns 0 on success, --help and --version, 1 on
 * every error and 2 on UnusableResult, with one line on stderr: `<app>: <message>`. A file that
 * exceeds the limit of the shell (`ulimit -f`) is an error, too, and not a signal.
 */
int runApp(int argc,
           char** argv,
           const std::function<void(CLI::App&)>& declare,
           const std::function<void()>& run);
}  // namespace dyslam
