// SPDX-License-Identifier: BSD-3-Clause
#include "OdometryCovariances.h"

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
/** Whether a trajectory differs from another one by its frame only, to the digits of their files.
 */
bool isMovedAsAWhole(const Trajectory& a, const Trajectory& b)
{
  constexpr double tolerance = 1e-6;  // [m] and [rad]
  if (a.size() != b.size() || a.size() == 0)
  {
    return false;
  }
  const Pose T_first_a = a[0].pose.inverse();
  const Pose T_first_b = b[0].pose.inverse();
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    const Pose T_a_b = (T_first_a * a[i].pose).inverse() * T_first_b * b[i].pose;
    if (std::abs(a[i].stamp - b[i].stamp) > same_scan_time ||
        T_a_b.translation().norm() > tolerance || rotationAngle(T_a_b) > tolerance)
    {
      return false;
    }
  }
  return true;
}
}  // namespace

OdometryCovariances::OdometryCovariances(const Trajectory& trajectory,
                                         const Trajectory& odometry,
                                         const std::vector<MotionCovariance>& motions)
{
  for (const MotionCovariance& motion : motions)
  {
    stamps_.push_back(motion.stamp);
    motions_.push_back(motion.covariance);
  }
  if (!isMovedAsAWhole(trajectory, odometry) || odometry.size() != motions.size())
  {
    return;
  }
  MotionAccumulator since_first;
  for (std::size_t i = 0; i < motions.size(); ++i)
  {
    if (std::abs(odometry[i].stamp - motions[i].stamp) > same_scan_time)
    {
      poses_.clear();
      return;
    }
    if (i > 0)
    {
      since_first.add(odometry[i - 1].pose.inverse() * odometry[i].pose, motions[i].covariance,
                      motions[i].pose_noise);
    }
    poses_.push_back(since_first.covariance());
  }
}

std::optional<std::size_t> OdometryCovariances::motionTo(double stamp) const
{
  const auto found = std::lower_bound(stamps_.begin(), stamps_.end(), stamp - same_scan_time);
  return found != stamps_.end() && *found <= stamp + same_scan_time
             ? std::optional(static_cast<std::size_t>(found - stamps_.begin()))
             : std::nullopt;
}

std::optional<Matrix6> OdometryCovariances::ofPose(double stamp) const
{
  const auto scan = motionTo(stamp);
  return scan && !poses_.empty() ? std::optional(poses_[*scan]) : std::nullopt;
}

std::optional<Matrix6> OdometryCovariances::ofMotion(double from, double to) const
{
  const auto before = motionTo(from);
  const auto scan = motionTo(to);
  return before && scan && *scan == *before + 1 ? std::optional(motions_[*scan]) : std::nullopt;
}

Matrix6 inParentAxes(const Matrix6& covariance, const Pose& T_parent_child)
{
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = T_parent_child.linear();
  turn.bottomRightCorner<3, 3>() = T_parent_child.linear();
  return turn * covariance * turn.transpose();
}
}  // namespace dyslam
