// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/ProgramLines.h>

#include <chrono>
#include <cstddef>
#include <string>

namespace dyslam
{
/** Prints the progress of long work on stderr: a bar with rate and time left on a terminal, else a
 * plain line every few seconds. */
class Progress
{
 public:
  /** \param unit counted unit, in the plural with an s \param quiet print nothing */
  explicit Progress(std::string what, std::string unit = "scans", bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /** \param fraction of the work done, 0 to 1; below 0 if unknown. \param count units done.
   * \param state said behind them: "0.3 s behind" */
  void update(double fraction, std::size_t count, const std::string& state = "");

  /** What was done before, of which the time is not known: rate and time left are of the rest,
   * which begins now. */
  void beginBehind(const EarlierWork& earlier);

  /** Says what is done behind the last unit, whose time is not known: on a terminal, else only
   * below earlier lines of progress. */
  void note(const std::string& work);

  /** To be called at the end: prints the last line. */
  void finish(std::size_t count);

 private:
  using Clock = std::chrono::steady_clock;

  void show(double fraction, std::size_t count, const std::string& state);
  void print(double fraction, const std::string& text);

  std::string what_;
  std::string unit_;
  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  EarlierWork earlier_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

/** Prints a line on stderr, in place of a line of progress, which comes again. */
void printAbove(const std::string& line);
}  // namespace dyslam
