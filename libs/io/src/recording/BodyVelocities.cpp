// SPDX-License-Identifier: BSD-3-Clause
#include "BodyVelocities.h"

#include <utility>

namespace dyslam
{
namespace
{
constexpr double longest_pose_step = 1;     //!< between poses whose difference is a velocity [s]
constexpr double smallest_velocity = 1e-6;  //!< of a pose that moves [m/s], [rad/s]
}  // namespace

std::optional<StampedVelocity> BodyVelocities::add(double stamp,
                                                   const std::optional<Vector6>& measured,
                                                   const std::optional<Pose>& T_parent_body)
{
  std::optional<StampedVelocity> difference;
  if (T_parent_body)
  {
    difference = differenceTo({stamp, *T_parent_body});
  }
  any_measured_ = any_measured_ || measured;
  all_zero_ = all_zero_ && (!measured || measured->isZero(0));
  if (measured && (!all_zero_ || !T_parent_body))
  {
    return StampedVelocity{stamp, *measured};
  }
  return difference;  // zero as well, if the body stands still
}

std::optional<StampedVelocity> BodyVelocities::differenceTo(const StampedPose& pose)
{
  const std::optional<StampedPose> last = std::exchange(last_pose_, pose);
  const double step = last ? pose.stamp - last->stamp : 0;
  if (step <= 0 || step > longest_pose_step)
  {
    return std::nullopt;
  }
  const Pose T_last_now = last->pose.inverse() * pose.pose;
  if (!T_last_now.matrix().allFinite())
  {
    return std::nullopt;
  }
  const Vector6 velocity = logSE3(T_last_now) / step;
  poses_move_ = poses_move_ || velocity.norm() > smallest_velocity;
  return StampedVelocity{last->stamp + step / 2, velocity};
}
}  // namespace dyslam
