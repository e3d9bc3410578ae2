// SPDX-License-Identifier: BSD-3-Clause
#include "LateStamps.h"

#include <dyslam/core/PointTimes.h>

#include <algorithm>

namespace dyslam
{
std::optional<double> firstOfLateStamp(const std::vector<float>& times)
{
  constexpr double late = 0.25;  // share of the duration
  const TimeExtent extent = timeExtent(times).value_or(TimeExtent());
  const auto first = static_cast<double>(extent.first);
  const auto last = static_cast<double>(extent.last);
  if (!(last > first))
  {
    return std::nullopt;
  }
  return (first + last) / 2 < -late * (last - first) ? first : 0;
}

void moveStamp(double shift, Scan& scan)
{
  if (shift == 0)
  {
    return;
  }
  scan.stamp += shift;
  for (float& time : scan.time)
  {
    time = static_cast<float>(time - shift);
  }
}

void LateStamps::examine(const std::vector<float>& times)
{
  const std::optional<double> first = firstOfLateStamp(times);
  shift_ = std::min(shift_, first.value_or(0));
  shown_ += first ? 1 : 0;
  examined_ += times.size() > 1 ? 1 : 0;
}

void LateStamps::operator()(Scan& scan)
{
  if (!isKnown())
  {
    examine(scan.time);
  }
  moveStamp(shift_, scan);
}

std::vector<std::string> LateStamps::notes() const
{
  if (shift_ == 0)
  {
    return {};
  }
  return {"time stamps: late in the scans; moved by " + std::to_string(-shift_) +
          " s to the first points"};
}
}  // namespace dyslam
