// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dyslam::batch
{
/** A program to run as a child process. It ends when this program ends, for whatever reason. */
struct ChildCommand
{
  std::vector<std::string> words;  //!< path of the program and its arguments
  std::string log;                 //!< file that its stdout and stderr are appended to
  std::vector<int> cores;          //!< cores that it may use; empty: all cores of this program
};

struct ChildOutcome
{
  int code = -1;                  //!< exit code; -1 if a signal ended it
  int signal = 0;                 //!< signal that ended it; 0: none
  double seconds = 0;             //!< wall time
  std::uint64_t peak_memory = 0;  //!< largest resident size [bytes]
};

/** Runs a program to its end. \param stop polled; true kills it and what it started.
 * \throws UserError that begins with the path of the program if it cannot be run. */
ChildOutcome runChild(const ChildCommand& command, const std::function<bool()>& stop = {});

/** The cores that this program may use; empty if the system does not tell, as with more than 1024.
 */
[[nodiscard]] std::vector<int> usableCores();
/** Memory that this program may still allocate [bytes]: the least of what the machine and the
 * program's control groups leave. */
[[nodiscard]] std::uint64_t availableMemory();
}  // namespace dyslam::batch
