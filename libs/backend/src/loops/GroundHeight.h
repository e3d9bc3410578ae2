// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Quantile.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dyslam
{
/** Height that one in `share` of the finite points lies below [m]; 0 without finite points. */
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
  return lowQuantile(heights, share);
}
}  // namespace dyslam
