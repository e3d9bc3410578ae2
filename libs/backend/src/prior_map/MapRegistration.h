// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/PriorMapOptions.h>

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "loops/KeyframeRegistration.h"
#include "loops/LoopVerification.h"

namespace dyslam
{
/** Least observability of a registration to the prior map that constrains all directions. */
constexpr double least_map_observability = 0.002;

/** The points within a horizontal range of the origin [m]. */
[[nodiscard]] inline std::vector<Eigen::Vector3f> pointsWithin(std::vector<Eigen::Vector3f> points,
                                                               double range)
{
  const auto limit = static_cast<float>(range);
  points.erase(
      std::remove_if(points.begin(), points.end(),
                     [limit](const Eigen::Vector3f& p) { return p.head<2>().norm() > limit; }),
      points.end());
  return points;
}

/** Whether a registration to the prior map fits, or the first criterion that it fails.
 * \param observability least one, see KeyframeRegistrationResult */
[[nodiscard]] inline LoopVerdict verdictOf(const KeyframeRegistrationResult& registration,
                                           const PriorMapOptions& options,
                                           double observability)
{
  LoopCriteria criteria;
  criteria.min_overlap = options.min_overlap;
  criteria.max_rmse = options.max_rmse;
  criteria.min_observability = observability;
  return verifyRegistration(registration, criteria);
}
}  // namespace dyslam
