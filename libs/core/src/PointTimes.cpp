// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PointTimes.h>

#include <algorithm>

namespace dyslam
{
std::optional<TimeExtent> timeExtent(const std::vector<float>& times)
{
  std::optional<TimeExtent> extent;
  for (const float time : times)
  {
    if (isPossibleTime(time))
    {
      extent = extent ? TimeExtent{std::min(extent->first, time), std::max(extent->last, time)}
                      : TimeExtent{time, time};
    }
  }
  return extent;
}
}  // namespace dyslam
