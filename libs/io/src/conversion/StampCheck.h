// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Printable.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Recognises scans that a run leaves out because their stamps are not after that of the scan
 * before, and clocks that were set. */
class StampCheck
{
 public:
  /** \param stamp of the next scan in the rawlog [s] */
  void add(double stamp)
  {
    constexpr double longest_back = 1;     // [s]; a clock that was set goes back further
    constexpr double longest_pause = 600;  // [s]
    const double step = last_ ? stamp - *last_ : 1;
    if (step <= 0 && step > -longest_back)
    {
      ++left_out_;
    }
    else
    {
      if (last_ && !jump_ && (step < 0 || step > longest_pause))
      {
        jump_ = Jump{count_, step};
      }
      last_ = stamp;
    }
    ++count_;
  }

  [[nodiscard]] std::vector<std::string> warnings() const
  {
    std::vector<std::string> result;
    if (left_out_ > 0)
    {
      result.push_back(
          formatted("the %s of %s %s not after that of the scan before: dyslam leaves %s out",
                    left_out_ == 1 ? "stamp" : "stamps", counted(left_out_, "scan").c_str(),
                    left_out_ == 1 ? "is" : "are", left_out_ == 1 ? "it" : "them"));
    }
    if (jump_)
    {
      result.push_back(formatted(
          "the stamps jump %s by %.0f s at scan %zu: %s", jump_->step > 0 ? "forward" : "back",
          jump_->step > 0 ? jump_->step : -jump_->step, jump_->scan,
          jump_->step > 0 ? "a clock that was set, or a pause, over which the motion is not known"
                          : "dyslam takes it as a clock that was set"));
    }
    return result;
  }

 private:
  struct Jump
  {
    std::size_t scan = 0;  //!< its number in the rawlog, from 0
    double step = 0;       //!< [s]
  };
  std::optional<double> last_;  //!< stamp of the last scan that is not left out [s]
  std::size_t count_ = 0;
  std::size_t left_out_ = 0;
  std::optional<Jump> jump_;  //!< the first
};
}  // namespace dyslam
