// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/StateArchive.h>

#include <cstddef>
#include <utility>

namespace dyslam
{
/** Results of scans that are reused for the next scans, and then forgotten together: those of the
 * present period, and those of the period before.
 *
 * \tparam T results, with clear() and exchangeState() */
template <typename T>
class Generations
{
 public:
  /** \param period number of scans after which the recent results become the older ones */
  explicit Generations(std::size_t period) : period_(period) {}

  /** Begins a scan: forgets results that were added `period` + 1 to 2 `period` scans before, up to
   * 3 `period` - 1 where numbers are left out. \param scan number of the scan, ascending */
  void beginScan(std::size_t scan)
  {
    const std::size_t passed = scan - begin_;
    if (passed >= period_)
    {
      std::swap(recent_, older_);
      recent_.clear();
      if (passed >= 2 * period_)
      {
        older_.clear();
      }
      begin_ = scan;
    }
  }

  [[nodiscard]] T& recent() { return recent_; }
  [[nodiscard]] const T& recent() const { return recent_; }
  [[nodiscard]] const T& older() const { return older_; }
  void exchangeState(StateArchive& archive) { archive(begin_, recent_, older_); }

 private:
  std::size_t period_;
  std::size_t begin_ = 0;  //!< number of the scan from which on results were added to `recent_`
  T recent_;
  T older_;
};
}  // namespace dyslam
