// SPDX-License-Identifier: BSD-3-Clause
#include "CloudCheck.h"

#include <dyslam/base/Printable.h>

#include <algorithm>
#include <vector>

namespace dyslam
{
void setReasonUnusable(const Frame& frame, MotionEstimate& motion)
{
  motion.reason.clear();
  motion.cause = FailureCause::estimation;
  const std::vector<Eigen::Vector3f>& points = frame.cloud.points;
  const std::size_t scanned = std::max(frame.scan.size(), points.size());
  if (scanned == 0)
  {
    motion.reason = "the scan has no points";
    motion.cause = FailureCause::recording;
    return;
  }
  const auto finite = static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [](const Eigen::Vector3f& p) { return p.allFinite(); }));
  if (finite >= min_scan_points)
  {
    return;
  }
  const std::vector<Eigen::Vector3f>& recorded = frame.scan.points;
  const auto returns =
      static_cast<std::size_t>(std::count_if(recorded.begin(), recorded.end(), isReturn));
  if (!recorded.empty() && returns < min_scan_points)
  {
    motion.reason = "the scan has only " + counted(returns, "return");
    motion.cause = FailureCause::recording;
    return;
  }
  motion.cause = FailureCause::preprocessing;
  motion.reason = "only " + std::to_string(finite) + " of " + std::to_string(scanned) + " points " +
                  (finite == 1 ? "is" : "are") +
                  " left after preprocess.min_range, own_vehicle_range and max_range";
}

std::string reasonUnusable(const Frame& frame)
{
  MotionEstimate motion;
  setReasonUnusable(frame, motion);
  return motion.reason;
}
}  // namespace dyslam
