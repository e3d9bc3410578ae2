// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Motion.h>

namespace dyslam
{
class StateArchive;

/** Error model of one odometry motion; tangents are [translation, rotation]. */
struct MotionCovariance
{
  double stamp = 0;  //!< stamp of the newer scan [s]
  bool is_keyframe = false;
  Matrix6 covariance = Matrix6::Zero();  //!< of T_previous_current's tangent [m, rad]
  Matrix6 pose_noise = Matrix6::Zero();  //!< see MotionEstimate
};

/** The motion over several scans with its covariance, as an edge between two keyframes needs it.
 *
 * The error of a motion has two parts: drift, which accumulates along the trajectory, and the noise
 * of the poses at its two ends (MotionEstimate::pose_noise); the next motion cancels the noise of
 * the newer pose. The covariance over several motions is therefore the sum of their drifts plus the
 * noise of the first and the last pose. Tangents are [translation, rotation], in m and rad.
 */
class MotionAccumulator
{
 public:
  /** Adds the next motion.
   * \param T_previous_current the motion \param covariance of the motion's tangent, including the
   * pose noise of both ends \param pose_noise of the newer end */
  void add(const Pose& T_previous_current, const Matrix6& covariance, const Matrix6& pose_noise);
  /** Resets the motion to the identity at the pose of the last motion. */
  void restart();

  /** Pose of the last scan in the frame of the scan at the last restart(). */
  [[nodiscard]] const Pose& motion() const { return T_start_now_; }
  /** Covariance of motion(), over its tangent; zero if nothing was added since restart(). */
  [[nodiscard]] Matrix6 covariance() const;
  void exchangeState(StateArchive& archive);

 private:
  Pose T_start_now_ = Pose::Identity();
  Matrix6 drift_ = Matrix6::Zero();  //!< covariance of the drift since the last restart()
  Matrix6 noise_of_start_ = Matrix6::Zero();
  Matrix6 noise_now_ = Matrix6::Zero();
  bool moved_ = false;  //!< a motion was added since the last restart()
};
}  // namespace dyslam
