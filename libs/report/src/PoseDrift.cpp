// SPDX-License-Identifier: BSD-3-Clause
#include "PoseDrift.h"

#include <dyslam/base/Angle.h>
#include <dyslam/core/PathLength.h>
#include <dyslam/core/Pose.h>
#include <dyslam/eval/TrajectoryMetrics.h>

namespace dyslam
{
PoseDrift poseDrift(const PosePairs& pairs)
{
  PoseDrift drift;
  const Pose T_reference_estimate = alignEstimate(pairs, Alignment::first);
  PathLength path;
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    drift.distance.push_back(path.add(pairs.reference[i].translation()));
    const Pose estimate = T_reference_estimate * pairs.estimate[i];
    const Eigen::Vector3d error = estimate.translation() - pairs.reference[i].translation();
    drift.position.push_back(error.head<2>().norm());
    drift.height.push_back(error.z());
    drift.heading.push_back(
        wrapAngle(yawPitchRoll(estimate).x() - yawPitchRoll(pairs.reference[i]).x()));
  }
  return drift;
}
}  // namespace dyslam
