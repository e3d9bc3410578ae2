// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace dyslam
{
/** The height that one in `share` finite points lies below; 0 if there are none. */
[[nodiscard]] inline float groundHeight(const std::vector<Eigen::Vector3f>& points,
                                        std::size_t share)
{
  std::vector<float> heights;
  heights.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
  {
    if (p.allFinite())
    {
      heights.push_back(p.z());
    }
  }
  if (heights.empty())
  {
    return 0;
  }
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / share);
  std::nth_element(heights.begin(), low, heights.end());
  return *low;
}
}  // namespace dyslam
