// SPDX-License-Identifier: BSD-3-Clause
#include "Progress.h"

#include <dyslam/base/Printable.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace dyslam
{
Progress::Progress(std::string what, std::string unit, bool quiet)
    : what_(std::move(what)), unit_(std::move(unit)), quiet_(quiet), terminal_(isatty(2) == 1)
{
}

Progress::~Progress()
{
  if (!quiet_ && terminal_ && shown_)
  {
    std::fputc('\n', stderr);
  }
}

void Progress::update(double fraction, std::size_t count, const std::string& state)
{
  const auto now = Clock::now();
  const double since = std::chrono::duration<double>(now - last_).count();
  if (quiet_ || since < (terminal_ ? 0.1 : 5.0))
  {
    return;
  }
  last_ = now;
  show(std::min(fraction, 0.99), count, state);  // finish() says 100%
}

void Progress::beginBehind(const EarlierWork& earlier)
{
  earlier_ = earlier;
  start_ = Clock::now();
}

void Progress::note(const std::string& work)
{
  if (!quiet_ && (terminal_ || shown_))
  {
    print(1, work);
  }
}

void Progress::finish(std::size_t count)
{
  if (!quiet_)
  {
    show(1, count, "");
  }
}

void Progress::show(double fraction, std::size_t count, const std::string& state)
{
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  print(fraction, progressText(fraction, count, unit_, seconds, earlier_) +
                      (state.empty() ? "" : ", " + state));
}

void Progress::print(double fraction, const std::string& text)
{
  shown_ = true;
  if (!terminal_)
  {
    std::fprintf(stderr, "%s: %s\n", what_.c_str(), text.c_str());
    return;
  }
  constexpr int width = 24;
  std::string bar(width, '.');
  for (int i = 0; i < width && i < fraction * width; ++i)
  {
    bar[static_cast<std::size_t>(i)] = '#';
  }
  std::fprintf(stderr, "\r\033[K%s [%s] %s", what_.c_str(), bar.c_str(), text.c_str());
  std::fflush(stderr);
}

void printAbove(const std::string& line)
{
  std::fprintf(stderr, "%s%s\n", isatty(2) == 1 ? "\r\033[K" : "", printable(line).c_str());
}
}  // namespace dyslam
