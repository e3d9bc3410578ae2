// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace dyslam::batch
{
/** Limits the number of runs by memory. The need of a run is known when it has ended; until then
 * the maximum of all earlier runs is assumed. Not thread-safe. */
class MemoryBudget
{
 public:
  /** \param total memory for all runs [bytes] \param first_estimate memory of a run, as assumed
   * before one has ended [bytes] */
  MemoryBudget(std::uint64_t total, std::uint64_t first_estimate)
      : total_(total), estimate_(first_estimate)
  {
  }

  /** Whether one more run may start; always true if none is running. \param alone the run must be
   * the only one */
  [[nodiscard]] bool fits(bool alone) const
  {
    return running_ == 0 || (!alone && !alone_ && (running_ + 1) * estimate_ <= total_);
  }
  void start(bool alone)
  {
    ++running_;
    alone_ = alone;
  }
  /** A run has ended. \param peak peak memory of the run [bytes]; 0 if it did not run */
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
