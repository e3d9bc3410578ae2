// SPDX-License-Identifier: BSD-3-Clause
#include "SimpleOdometry.h"

#include <algorithm>

namespace dyslam
{
std::string cloudTrouble(const Frame& frame)
{
  const std::vector<Eigen::Vector3f>& points = frame.cloud.points;
  if (points.empty())
  {
    return "the frame has no points";
  }
  const auto finite = static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [](const Eigen::Vector3f& p) { return p.allFinite(); }));
  if (finite < fewest_points)
  {
    return "the frame has only " + std::to_string(finite) + " finite points";
  }
  return {};
}

MotionEstimate SimpleOdometry::process(const Frame& frame,
                                       const Pose& T_previous_current_prediction,
                                       const Matrix6& /*information*/)
{
  MotionEstimate estimate;
  constexpr double degree = 3.14159265358979323846 / 180;
  estimate.information.setZero();
  estimate.information.diagonal() << 100, 100, 100, 1 / (degree * degree), 1 / (degree * degree),
      1 / (degree * degree);
  estimate.reason = cloudTrouble(frame);
  estimate.converged = estimate.reason.empty();
  const bool first = first_;
  first_ = false;
  if (!first && (kind_ == Kind::constant_velocity || !estimate.converged))
  {
    estimate.T_previous_current = T_previous_current_prediction;
  }
  return estimate;
}

std::string SimpleOdometry::name() const
{
  return kind_ == Kind::constant_velocity ? "constant_velocity" : "zero_motion";
}
}  // namespace dyslam
