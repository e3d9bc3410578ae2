// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/AreaUnderCurve.h>

#include <algorithm>
#include <limits>

namespace dyslam
{
double areaUnderCurve(std::vector<float> high, const std::vector<float>& low)
{
  if (high.empty() || low.empty())
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::sort(high.begin(), high.end());
  double pairs = 0;
  for (const float score : low)
  {
    const auto [first, last] = std::equal_range(high.begin(), high.end(), score);
    pairs += static_cast<double>(high.end() - last) + 0.5 * static_cast<double>(last - first);
  }
  return pairs / static_cast<double>(high.size()) / static_cast<double>(low.size());
}
}  // namespace dyslam
