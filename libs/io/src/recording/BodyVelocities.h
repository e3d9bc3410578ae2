// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <optional>

namespace dyslam
{
/** Velocity of a body at one instant. */
struct StampedVelocity
{
  double stamp = 0;                    //!< UNIX time [s]
  Vector6 velocity = Vector6::Zero();  //!< along the body's axes [m/s], [rad/s]
};

/** Velocities of a body by its odometry: those that were measured or, as long as these are missing
 * or all zero, the differences of its poses. Some drivers fill in the pose alone. */
class BodyVelocities
{
 public:
  /** \param stamp UNIX time [s] \param measured velocity along the body's axes [m/s], [rad/s]
   * \param T_parent_body pose in a fixed frame
   * \return the measured velocity, or the one between the previous pose and this one, at the middle
   * of their times; nothing if these are more than 1 s apart, not in order or not finite. */
  [[nodiscard]] std::optional<StampedVelocity> add(double stamp,
                                                   const std::optional<Vector6>& measured,
                                                   const std::optional<Pose>& T_parent_body);
  /** Whether all measured velocities so far are zero, while the poses move. */
  [[nodiscard]] bool replacesZeros() const { return any_measured_ && all_zero_ && poses_move_; }

 private:
  [[nodiscard]] std::optional<StampedVelocity> differenceTo(const StampedPose& pose);

  std::optional<StampedPose> last_pose_;
  bool any_measured_ = false;
  bool all_zero_ = true;  //!< all measured velocities so far are zero
  bool poses_move_ = false;
};
}  // namespace dyslam
