// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Motion.h>

namespace dyslam
{
class StateArchive;

/** Ini section `[uncertainty]`: covariance of the odometry. Calibrated on recordings with ground
 * truth, so that the mean of e' * information * e is near 6. */
struct UncertaintyOptions : Options
{
  int window = 10;                  //!< number of motions over which the jitter is averaged
  double jitter_translation = 0.7;  //!< ratio of the position error variance to the jitter's
  double jitter_rotation = 2;       //!< ratio of the rotation error variance to the jitter's
  /** Fraction of a pose's error variance that remains in the local map and all later poses. */
  double jitter_drift = 0.2;
  /** Factor on the registration's covariance of a pose, most of which is measured as jitter. */
  double registration_covariance_scale = 0.003;
  /** Factor on the covariance of a motion by the prior of a registration or by a scan matcher,
   * which accumulates. */
  double motion_covariance_scale = 0.05;

  void describe(OptionsVisitor& visitor) override;
};

/** Calibrates the covariance of a motion by the jitter of the estimated motions.
 *
 * A registration's normal equations contain only the noise of its residuals. The dominant errors
 * are common to thousands of points: surfaces sampled by the same few rings, deskewing under
 * constant velocity, earlier errors of the map. Such errors are independent from scan to scan and
 * make the estimated motion jitter. If the errors of the poses are independent with variance v, the
 * second difference of the motions has the variance 20 v; it is measured over the last motions,
 * component by component. A true change of the acceleration counts too: deskewing cannot model it.
 * Directions that the points do not constrain do not jitter, since the prior determines them; the
 * covariance of the estimate itself covers these.
 */
class MotionUncertainty
{
 public:
  /** \throws UserError for options out of range. */
  explicit MotionUncertainty(const UncertaintyOptions& options);

  /** Replaces motion.information by the calibrated one and sets motion.pose_noise.
   *
   * For a registration to a map. On entry, motion.information is that of the estimate including the
   * prior, and positive definite.
   * \param dt time since the previous scan [s]; 0 or less: no motion, nothing is done
   * \param in_map information of the points about the pose in the local map */
  void calibrate(double dt, const Matrix6& in_map, MotionEstimate& motion);

  /** calibrate() for a scan matcher; on entry, motion.information is the matcher's own.
   * \param prior information of the prior, positive definite, which is kept in directions that no
   * point constrains */
  void calibrateMatch(double dt, const Matrix6& prior, MotionEstimate& motion);

  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

 private:
  void measureJitter(double dt, const MotionEstimate& motion);
  /** Factor on the estimate's covariance: 1 after few motions, or if this motion failed. */
  [[nodiscard]] double covarianceScale(double calibrated, const MotionEstimate& motion) const;
  /** Sets the pose noise and the information of `motion`.
   * \param of_points covariance of the pose in the map \param drift covariance of the motion that
   * remains in all later poses; both without the jitter */
  void setCovariance(const Matrix6& of_points, const Matrix6& drift, MotionEstimate& motion);

  UncertaintyOptions options_;
  Vector6 velocity_ = Vector6::Zero();      //!< mean velocity of the last motion [m/s, rad/s]
  Vector6 acceleration_ = Vector6::Zero();  //!< change of the last two velocities [m/s, rad/s]
  /** Variance of a pose's error that explains the jitter [m^2, rad^2]. */
  Vector6 jitter_ = Vector6::Zero();
  int motions_ = 0;                         //!< number of motions in a row that converged
  int samples_ = 0;                         //!< number of motions averaged in jitter_
  Matrix6 noise_before_ = Matrix6::Zero();  //!< covariance of the noise of the previous pose
};
}  // namespace dyslam
