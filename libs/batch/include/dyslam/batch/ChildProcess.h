// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dyslam::batch
{
/** A program to run beside this one. It ends when this one does, however that comes about. */
struct ChildCommand
{
  std::vector<std::string> words;  //!< path of the program and its arguments
  std::string log;                 //!< file that its stdout and stderr are appended to
  std::vector<int> cores;          //!< that it may use; empty: those of this program
};

struct ChildOutcome
{
  int code = -1;                  //!< exit code; -1 if a signal ended it
  int signal = 0;                 //!< that ended it
  double seconds = 0;             //!< wall time
  std::uint64_t peak_memory = 0;  //!< largest resident size [bytes]
};

/** Runs a program to its end. \param stop polled; true kills it and what it started.
 * \throws UserError if it cannot be started. */
ChildOutcome runChild(const ChildCommand& command, const std::function<bool()>& stop = {});

/** The cores that this program may use; empty if the system does not tell, as with more than 1024.
 */
[[nodiscard]] std::vector<int> usableCores();
/** Memory that this program may still take: the least of what the machine and its control
 * groups leave [bytes]. */
[[nodiscard]] std::uint64_t availableMemory();
}  // namespace dyslam::batch
