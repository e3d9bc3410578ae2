// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/core/PointTimes.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Recognises times of points in a unit that no driver has, and scans of several lidars in one
 * topic: the points of a scan then have times over more than the interval to the next scan. */
class SpanCheck
{
 public:
  /** \param number of the scan in the recording; only successive ones are compared */
  void add(std::size_t number, const Scan& scan)
  {
    constexpr std::size_t enough = 50;  // scans
    const double interval = scan.stamp - last_stamp_;
    const bool is_next = last_number_ && number == *last_number_ + 1;
    last_number_ = number;
    last_stamp_ = scan.stamp;
    const double duration = timeExtent(scan.time).value_or(TimeExtent()).duration();
    if (is_next && interval > 0 && duration > 0 && intervals_.size() < enough)
    {
      intervals_.push_back(interval);
      durations_.push_back(duration);
    }
  }

  /** The warning; empty if there is none. */
  [[nodiscard]] std::string warning() const
  {
    constexpr std::size_t fewest = 10;
    constexpr double longest = 1.5;  // intervals
    if (intervals_.size() < fewest)
    {
      return "";
    }
    std::vector<double> intervals = intervals_;
    std::vector<double> durations = durations_;
    const double interval = upperMedian(intervals);
    const double duration = upperMedian(durations);
    return duration > longest * interval
               ? formatted(
                     "the points of a scan have times over %.3g s, but scans are %.3g s apart: "
                     "the unit of these times may be wrong, or the topic has scans of "
                     "several lidars; without the times: preprocess.deskew=none",
                     duration, interval)
               : "";
  }

 private:
  std::optional<std::size_t> last_number_;
  double last_stamp_ = 0;          //!< [s]
  std::vector<double> intervals_;  //!< from the scan before [s]
  std::vector<double> durations_;  //!< of the times of the points [s]
};
}  // namespace dyslam
