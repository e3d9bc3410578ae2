// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Association.h>

#include <cmath>

namespace dyslam
{
/** True poses on a circle of 100 m, and an estimate whose radius grows. \param drift growth of the
 * radius per pose [m] */
inline PosePairs circle(double drift)
{
  PosePairs pairs;
  for (int i = 0; i < 300; ++i)
  {
    const double a = 0.02 * i;
    pairs.stamps.push_back(i);
    pairs.reference.push_back(poseFromYpr(100 * std::sin(a), 100 * (1 - std::cos(a)), 0, a, 0, 0));
    pairs.estimate.push_back(
        poseFromYpr((100 + drift * i) * std::sin(a), 100 * (1 - std::cos(a)), 0.1, a, 0, 0));
  }
  pairs.reference_size = pairs.estimate_size = pairs.stamps.size();
  return pairs;
}
}  // namespace dyslam
