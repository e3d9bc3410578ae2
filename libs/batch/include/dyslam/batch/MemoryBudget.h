// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace dyslam::batch
{
/** Number of runs that fit into memory. The need of a run is known when it has ended; until then
 * the maximum of all earlier runs is assumed. Not thread-safe. */
class MemoryBudget
{
 public:
  /** \param total for all runs \param first_estimate of a run before one has ended [bytes] */
  MemoryBudget(std::uint64_t total, std::uint64_t first_estimate)
      : total_(total), estimate_(first_estimate)
  {
  }

  /** Whether one more may start; if none is running, always. \param alone nothing beside it. */
  [[nodiscard]] bool fits(bool alone) const
  {
    return running_ == 0 || (!alone && !alone_ && (running_ + 1) * estimate_ <= total_);
  }
  void start(bool alone)
  {
    ++running_;
    alone_ = alone;
  }
  /** \param peak memory that the run took [bytes]; 0 if it did not run. */
  void finish(std::uint64_t peak)
  {
    --running_;
    alone_ = false;
    if (peak > 0)
    {
      largest_ = peak > largest_ ? peak : largest_;
      estimate_ = largest_;
    }
  }

 private:
  std::uint64_t total_;
  std::uint64_t estimate_;
  std::uint64_t largest_ = 0;
  std::uint64_t running_ = 0;
  bool alone_ = false;
};
}  // namespace dyslam::batch
