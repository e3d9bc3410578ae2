// SPDX-License-Identifier: BSD-3-Clause
#include "LateStamps.h"

#include <algorithm>
#include <limits>

namespace dyslam
{
std::optional<double> firstOfLateStamp(const std::vector<float>& times)
{
  constexpr double late = 0.25;  // share of the duration
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const float time : times)
  {
    if (isPossibleTime(time))
    {
      first = std::min(first, static_cast<double>(time));
      last = std::max(last, static_cast<double>(time));
    }
  }
  if (!(last > first))
  {
    return std::nullopt;
  }
  return (first + last) / 2 < -late * (last - first) ? first : 0;
}

void LateStamps::operator()(Scan& scan)
{
  constexpr int enough = 2;
  if (scans_ < enough)
  {
    const std::optional<double> first = firstOfLateStamp(scan.time);
    shift_ = std::min(shift_, first.value_or(0));
    scans_ += first ? 1 : 0;
  }
  if (shift_ == 0)
  {
    return;
  }
  scan.stamp += shift_;
  for (float& time : scan.time)
  {
    time = static_cast<float>(time - shift_);
  }
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
