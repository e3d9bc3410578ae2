// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <string>

namespace dyslam
{
/** Stage that caused the failure of a motion estimate. */
enum class FailureCause
{
  estimation,    //!< matching or registration; also the value where nothing failed
  recording,     //!< the scan has too few returns
  preprocessing  //!< too few points of the scan are left in the cloud
};

/** How a motion was found. */
enum class MotionStatus
{
  not_found,    //!< no points were registered, or not well enough: the motion is predicted
  not_settled,  //!< registered and accepted, but the iterations ended while it still changed
  converged     //!< registered and accepted
};

/** A relative motion with its information matrix. */
struct MotionEstimate
{
  /** Takes points of this scan's vehicle frame to the previous scan's. */
  Pose T_previous_current = Pose::Identity();
  /** Information matrix of log(T_measured^-1 T), [translation, rotation] [1/m^2, 1/rad^2]. */
  Matrix6 information = Matrix6::Identity();
  /** Covariance (tangent of the pose) of the part of this scan's pose error that does not
   * accumulate: a registration to a map has an independent error at each scan, which the next
   * motion cancels. Zero where all errors accumulate. `information` includes the pose noise of this
   * scan and of the scan before. */
  Matrix6 pose_noise = Matrix6::Zero();
  MotionStatus status = MotionStatus::not_found;
  int iterations = 0;
  std::size_t inliers = 0;
  double rmse = 0;                                //!< of the inliers' residuals [m]
  std::string reason;                             //!< why `status` is not converged; empty if it is
  FailureCause cause = FailureCause::estimation;  //!< kind of the reason
  bool map_restarted = false;  //!< the local map is started anew from this scan, after failures

  /** The motion was found from the points of the scan; otherwise it is predicted. True for the
   * first scan of a map, too, which has nothing to be registered to. */
  [[nodiscard]] bool registered() const { return status != MotionStatus::not_found; }
  /** It is registered and settled: its covariance can be that of its residuals. */
  [[nodiscard]] bool converged() const { return status == MotionStatus::converged; }
};

/** Prior of the motion since the previous scan, before this scan's points are used. */
struct MotionPrior
{
  Pose T_previous_current = Pose::Identity();
  /** Information of log(T_prior^-1 T), [translation, rotation]; zero where nothing is known. */
  Matrix6 information = Matrix6::Zero();
  /** Whether the prior is accurate enough to restrict the search for the motion to its
   * surroundings. */
  bool reliable = false;

  /** Fuse an independent measurement of the same motion (Gaussian product, first order). */
  void fuse(const Pose& T_measured, const Matrix6& measured_information);
  /** Mahalanobis distance to a measurement with its own standard deviations [m] and [rad]. \pre
   * `information` is positive definite. */
  [[nodiscard]] double mahalanobisDistance(const Pose& T_measured,
                                           double sigma,
                                           double sigma_angle) const;
};

/** Information matrix of independent errors: `sigma` along each axis [m], `sigma_angle` about each
 * axis [rad]. */
[[nodiscard]] Matrix6 informationFromSigmas(double sigma, double sigma_angle);
}  // namespace dyslam
