// SPDX-License-Identifier: BSD-3-Clause
#include "RunTimes.h"

namespace dyslam
{
using mrpt::system::CTimeLogger;

RunTimes::RunTimes() : stages_(true, "dyslam")
{
  stages_.setMinLoggingLevel(mrpt::system::LVL_ERROR);  // otherwise it prints a table at the end
}

void RunTimes::beginEarlier(double seconds)
{
  begin_ -= std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds));
}

double RunTimes::seconds() const
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

std::map<std::string, double> RunTimes::stageMilliseconds(std::size_t scans) const
{
  const std::size_t timed = scans - left_out_;
  std::map<std::string, CTimeLogger::TCallStats> stats;
  stages_.getStats(stats);
  std::map<std::string, double> ms;
  for (const auto& [stage, stat] : stats)
  {
    ms[stage] = timed > 0 ? 1e3 * stat.total_t / static_cast<double>(timed) : 0;
  }
  return ms;
}

std::map<std::string, double> RunTimes::waitMilliseconds(std::size_t scans,
                                                         const QueueWaits& writing) const
{
  const std::size_t timed = scans - left_out_;
  std::map<std::string, double> waits = waits_;
  waits["back_end"] += writing.for_room;
  waits["writing"] += writing.for_items;
  for (auto& [thread, wait] : waits)
  {
    wait *= timed > 0 ? 1e3 / static_cast<double>(timed) : 0;
  }
  return waits;
}
}  // namespace dyslam
