// SPDX-License-Identifier: BSD-3-Clause
#include "PoseDrift.h"

#include <dyslam/core/Pose.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <cmath>

namespace dyslam
{
PoseDrift poseDrift(const PosePairs& pairs)
{
  PoseDrift drift;
  drift.distance = distanceTravelled(pairs.reference);
  const Pose T_reference_estimate = alignEstimate(pairs, Alignment::first);
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    const Pose estimate = T_reference_estimate * pairs.estimate[i];
    const Eigen::Vector3d error = estimate.translation() - pairs.reference[i].translation();
    drift.position.push_back(error.head<2>().norm());
    drift.height.push_back(error.z());
    drift.heading.push_back(std::remainder(
        yawPitchRoll(estimate).x() - yawPitchRoll(pairs.reference[i]).x(), 2 * M_PI));
  }
  return drift;
}
}  // namespace dyslam
