// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Motion.h>

namespace dyslam
{
class StateArchive;

/** What the odometry states of the error of one motion; tangents are [translation, rotation]. */
struct MotionCovariance
{
  double stamp = 0;  //!< of the newer scan [s]
  bool is_keyframe = false;
  Matrix6 covariance = Matrix6::Zero();  //!< of the motion since the scan before [m, rad]
  Matrix6 pose_noise = Matrix6::Zero();  //!< see MotionEstimate
};

/** The motion over several scans with its covariance, as an edge between two keyframes needs it.
 *
 * Of the error of a motion one part stays in the trajectory and adds up; the other is the noise of
 * the two poses at its ends (MotionEstimate::pose_noise), and the next motion takes the noise of
 * the newer one back. The covariance over several motions is therefore the sum of what stays, and
 * the noise of the first and the last pose. Tangents are [translation, rotation], in m and rad.
 */
class MotionAccumulator
{
 public:
  /** Adds the next motion.
   * \param T_previous_current the motion \param covariance its own, over its tangent, pose noise of
   * both ends included \param pose_noise of its newer end */
  void add(const Pose& T_previous_current, const Matrix6& covariance, const Matrix6& pose_noise);
  /** Starts anew at the pose of the last motion. */
  void restart();

  /** Of the last pose in the frame of the one where it started. */
  [[nodiscard]] const Pose& motion() const { return T_start_now_; }
  /** Over the tangent of motion(); zero where nothing has been added since the start. */
  [[nodiscard]] Matrix6 covariance() const;
  void exchangeState(StateArchive& archive);

 private:
  Pose T_start_now_ = Pose::Identity();
  Matrix6 drift_ = Matrix6::Zero();  //!< what stays, of the motions so far
  Matrix6 noise_of_start_ = Matrix6::Zero();
  Matrix6 noise_now_ = Matrix6::Zero();
  bool moved_ = false;  //!< something was added since the start
};
}  // namespace dyslam
