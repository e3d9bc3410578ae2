// SPDX-License-Identifier: BSD-3-Clause
#include "OdometryChain.h"

#include <dyslam/base/StateArchive.h>

#include <Eigen/Dense>

namespace dyslam
{
namespace
{
/** Sigma of the rotation over an unmeasured stretch of the path [rad]. */
constexpr double unseen_rotation = 0.5;

/** Covariance of one odometry step: that of the odometry (a step that was not registered has the
 * prior's, large after a gap), and the option's in addition where it did not converge. */
Matrix6 stepCovariance(const MotionEstimate& motion, const BackendOptions& options)
{
  Vector6 sigmas;
  sigmas << Eigen::Vector3d::Constant(options.unconverged_sigma),
      Eigen::Vector3d::Constant(options.unconverged_sigma_rotation);
  const Matrix6 unconverged = sigmas.array().square().matrix().asDiagonal();
  if (motion.information.allFinite())
  {
    const Eigen::LLT<Matrix6> cholesky(motion.information);
    if (cholesky.info() == Eigen::Success)
    {
      const Matrix6 own = cholesky.solve(Matrix6::Identity());
      if (own.allFinite())
      {
        const Matrix6 symmetric = symmetricPart(own);
        return motion.converged() ? symmetric : Matrix6(symmetric + unconverged);
      }
    }
  }
  return unconverged;
}
}  // namespace

Pose OdometryChain::add(const Frame& frame, bool is_first)
{
  path_.add(frame.T_odom_vehicle.translation());
  const Pose step = T_odom_previous_.inverse() * frame.T_odom_vehicle;
  T_odom_previous_ = frame.T_odom_vehicle;
  if (is_first)
  {
    return step;
  }
  const double unseen = unseen_path_.add(frame, step.translation().norm());
  Matrix6 own = stepCovariance(frame.motion, options_);
  if (unseen > 0)
  {
    own.diagonal().head<3>().array() += unseen * unseen;
    own.diagonal().tail<3>().array() += unseen_rotation * unseen_rotation;
  }
  since_keyframe_.add(step, own, frame.motion.pose_noise);
  const Vector6 lasting = (own - 2 * frame.motion.pose_noise).diagonal().cwiseMax(0);
  drift_ += lasting.head<3>().mean();
  drift_angle_ += lasting.tail<3>().mean();
  return step;
}

bool OdometryChain::isKeyframeDue() const
{
  const Pose& moved = since_keyframe_.motion();
  return moved.translation().norm() >= options_.keyframe_distance ||
         rotationAngle(moved) >= options_.keyframe_angle;
}

void OdometryChain::beginAtKeyframe()
{
  T_odom_keyframe_ = T_odom_previous_;
  since_keyframe_.restart();
}

void OdometryChain::exchangeState(StateArchive& archive)
{
  archive(T_odom_keyframe_, since_keyframe_, T_odom_previous_, path_, unseen_path_, drift_,
          drift_angle_);
}
}  // namespace dyslam
