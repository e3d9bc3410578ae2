// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Motion.h>
#include <dyslam/core/Options.h>

namespace dyslam
{
class StateArchive;

/** Ini section `[uncertainty]`: the covariance that the odometry reports. Calibrated on recordings
 * with ground truth, so that the mean of e' * information * e is near 6. */
struct UncertaintyOptions : Options
{
  int window = 10;                  //!< motions that the jitter is averaged over
  double jitter_translation = 0.7;  //!< variance of a pose's error over that of its jitter
  double jitter_rotation = 2;       //!< the same of its rotation
  /** Of a pose's error, as variance, that stays in the local map and all later poses. */
  double jitter_drift = 0.2;
  /** Of the registration's own covariance of a pose: most of what it states shows as jitter. */
  double registration_share = 0.003;
  /** Of the covariance that the prior leaves to a registration, and of a scan matcher's own: it
   * adds up. */
  double motion_share = 0.05;

  void describe(OptionsVisitor& visitor) override;
};

/** States how far a motion may be off, from how evenly the vehicle seems to move.
 *
 * A registration's normal equations know the noise of its residuals only. What dominates the error
 * is common to thousands of points: surfaces sampled by the same few rings, a sweep deskewed as if
 * the velocity were constant in it, a map that erred before. Such errors are new at every scan and
 * make the estimated motion jitter. Where each pose errs by itself with variance v, the second
 * difference of the motions has the variance 20 v; it is measured over the last motions, component
 * by component. A real change of the acceleration counts too: that is what deskewing cannot follow.
 * Directions that the points leave open do not jitter, since the prior holds them; the covariance
 * of the estimate itself states these.
 */
class MotionUncertainty
{
 public:
  /** \throws UserError for options out of range. */
  explicit MotionUncertainty(const UncertaintyOptions& options);

  /** Replaces motion.information by the calibrated one and sets motion.pose_noise.
   *
   * For a registration to a map. Before, motion.information is that of the estimate, prior
   * included, and positive definite.
   * \param dt since the previous scan [s]; up to 0: there is no motion, nothing is done
   * \param in_map information of the points about the pose in the local map */
  void calibrate(double dt, const Matrix6& in_map, MotionEstimate& motion);

  /** The same for a scan matcher alone; motion.information is the matcher's own.
   * \param prior its information, positive definite: a direction that no point fixes stays as the
   * prior has it */
  void calibrateMatch(double dt, const Matrix6& prior, MotionEstimate& motion);

  /** What is kept from frame to frame. */
  void exchangeState(StateArchive& archive);

 private:
  void measureJitter(double dt, const MotionEstimate& motion);
  /** Few motions have been seen, or this one failed: what the estimate states counts in full. */
  [[nodiscard]] double share(double calibrated, const MotionEstimate& motion) const;
  /** \param of_points covariance of the pose in the map \param drift of the motion, both but for
   * the jitter */
  void state(const Matrix6& of_points, const Matrix6& drift, MotionEstimate& motion);

  UncertaintyOptions options_;
  Vector6 velocity_ = Vector6::Zero();      //!< of the last motion [m/s, rad/s]
  Vector6 acceleration_ = Vector6::Zero();  //!< change of the last two velocities [m/s, rad/s]
  Vector6 jitter_ = Vector6::Zero();        //!< variance of a pose's error that explains it
  int motions_ = 0;                         //!< in a row that converged
  int samples_ = 0;                         //!< in jitter_
  Matrix6 noise_before_ = Matrix6::Zero();  //!< of the previous scan's pose
};
}  // namespace dyslam
