// SPDX-License-Identifier: BSD-3-Clause
#include "SimpleOdometry.h"

#include <dyslam/core/Printable.h>

#include <algorithm>

namespace dyslam
{
std::string cloudTrouble(const Frame& frame)
{
  const std::vector<Eigen::Vector3f>& points = frame.cloud.points;
  const std::size_t scanned = std::max(frame.scan.size(), points.size());
  if (scanned == 0)
  {
    return "the scan has no points";
  }
  const auto finite = static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [](const Eigen::Vector3f& p) { return p.allFinite(); }));
  if (finite >= fewest_points)
  {
    return {};
  }
  const std::vector<Eigen::Vector3f>& recorded = frame.scan.points;
  const auto returns =
      static_cast<std::size_t>(std::count_if(recorded.begin(), recorded.end(), isReturn));
  if (!recorded.empty() && returns < fewest_points)
  {
    return "the scan has only " + counted(returns, "return");
  }
  return "only " + std::to_string(finite) + " of " + std::to_string(scanned) + " points " +
         (finite == 1 ? "is" : "are") + " left after preprocess.min_range and max_range";
}

ScanMatch SimpleOdometry::match(const Frame& frame, const MotionPrior& prior)
{
  constexpr double degree = 3.14159265358979323846 / 180;
  ScanMatch match;
  match.motion.information = informationFromSigmas(0.1, degree);
  match.motion.reason = cloudTrouble(frame);
  match.motion.converged = match.motion.reason.empty();
  const bool first = first_;
  first_ = false;
  if (!first && (kind_ == Kind::constant_velocity || !match.motion.converged))
  {
    match.motion.T_previous_current = prior.T_previous_current;
  }
  return match;
}

std::string SimpleOdometry::name() const
{
  return kind_ == Kind::constant_velocity ? "constant_velocity" : "zero_motion";
}
}  // namespace dyslam
