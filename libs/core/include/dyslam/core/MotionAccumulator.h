// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Motion.h>

namespace dyslam
{
class StateArchive;

/** Error model of one odometry motion; tangents are [translation, rotation]. */
struct MotionCovariance
{
  double stamp = 0;  //!< of the newer scan [s]
  bool is_keyframe = false;
  Matrix6 covariance = Matrix6::Zero();  //!< of the motion since the scan before [m, rad]
  Matrix6 pose_noise = Matrix6::Zero();  //!< see MotionEstimate
};

/** The motion over several scans with its covariance, as an edge between two keyframes needs it.
 *
 * The error of a motion has two parts: drift, which accumulates along the trajectory, and the noise
 * of the poses at its two ends (MotionEstimate::pose_noise); the next motion cancels that of the
 * newer one. The covariance over several motions is therefore the sum of their drift, and the noise
 * of the first and the last pose. Tangents are [translation, rotation], in m and rad.
 */
class MotionAccumulator
{
 public:
  /** Adds the next motion.
   * \param T_previous_current the motion \param covariance its own, over its tangent, pose noise of
   * both ends included \param pose_noise of its newer end */
  void add(const Pose& T_previous_current, const Matrix6& covariance, const Matrix6& pose_noise);
  /** Resets the motion to the identity at the pose of the last motion. */
  void restart();

  /** Of the last pose in the frame of the one where it started. */
  [[nodiscard]] const Pose& motion() const { return T_start_now_; }
  /** Over the tangent of motion(); zero where nothing has been added since the start. */
  [[nodiscard]] Matrix6 covariance() const;
  void exchangeState(StateArchive& archive);

 private:
  Pose T_start_now_ = Pose::Identity();
  Matrix6 drift_ = Matrix6::Zero();  //!< sum of the motions so far
  Matrix6 noise_of_start_ = Matrix6::Zero();
  Matrix6 noise_now_ = Matrix6::Zero();
  bool moved_ = false;  //!< something was added since the start
};
}  // namespace dyslam
