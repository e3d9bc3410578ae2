// SPDX-License-Identifier: BSD-3-Clause
#include "MotionUncertainty.h"

#include <dyslam/base/StateArchive.h>

#include <Eigen/Cholesky>
#include <algorithm>

namespace dyslam
{
namespace
{
/** Variance of the second difference of motions between poses of unit variance: 1 + 9 + 9 + 1. */
constexpr double white_noise_gain = 20;
/** Least number of jitter samples for scaling the estimate's own covariance. */
constexpr int min_samples = 3;
/** Smallest reported standard deviations [m], [rad]. */
constexpr double min_sigma = 1e-4;
constexpr double min_sigma_angle = 1e-5;
}  // namespace

void UncertaintyOptions::describe(OptionsVisitor& v)
{
  v.integer("window", window, 1, 1000,
            "number of motions over which the measured jitter is averaged");
  v.real(
      "jitter_translation", jitter_translation, 0, 1000,
      "ratio of a pose's position error variance to the measured variance of the position jitter");
  v.real(
      "jitter_rotation", jitter_rotation, 0, 1000,
      "ratio of a pose's rotation error variance to the measured variance of the rotation jitter");
  v.real("jitter_drift", jitter_drift, 0, 1000,
         "fraction of a pose's error variance that remains in all later poses");
  v.real("registration_covariance_scale", registration_covariance_scale, 0, 1000,
         "factor on the covariance of a pose from the registration");
  v.real("motion_covariance_scale", motion_covariance_scale, 0, 1000,
         "factor on the covariance of a motion from the prior or a scan matcher");
}

MotionUncertainty::MotionUncertainty(const UncertaintyOptions& options) : options_(options)
{
  validate(options_, "uncertainty");
}

void MotionUncertainty::measureJitter(double dt, const MotionEstimate& motion)
{
  if (!motion.converged())
  {
    motions_ = 0;
    return;
  }
  const Vector6 velocity = logSE3(motion.T_previous_current) / dt;
  const Vector6 acceleration = velocity - velocity_;
  if (++motions_ >= 3)
  {
    const Vector6 jitter = dt * (acceleration - acceleration_);
    ++samples_;
    const double share = 1.0 / std::min(samples_, options_.window);
    jitter_ += share * (jitter.cwiseAbs2() / white_noise_gain - jitter_);
  }
  acceleration_ = acceleration;
  velocity_ = velocity;
}

double MotionUncertainty::covarianceScale(double calibrated, const MotionEstimate& motion) const
{
  return motion.converged() && samples_ >= min_samples ? calibrated : 1;
}

void MotionUncertainty::setCovariance(const Matrix6& of_points,
                                      const Matrix6& drift,
                                      MotionEstimate& motion)
{
  Vector6 jitter = jitter_;
  jitter.head<3>() *= options_.jitter_translation;
  jitter.tail<3>() *= options_.jitter_rotation;
  motion.pose_noise = of_points;
  motion.pose_noise.diagonal() += jitter;
  motion.pose_noise.diagonal().head<3>().array() += min_sigma * min_sigma;
  motion.pose_noise.diagonal().tail<3>().array() += min_sigma_angle * min_sigma_angle;
  const Matrix6 back = adjointSE3(motion.T_previous_current.inverse());
  Matrix6 covariance = motion.pose_noise + back * noise_before_ * back.transpose() + drift;
  covariance.diagonal() += options_.jitter_drift * jitter;
  noise_before_ = motion.pose_noise;
  motion.information = symmetricPart(covariance.llt().solve(Matrix6::Identity()));
}

void MotionUncertainty::calibrate(double dt, const Matrix6& in_map, MotionEstimate& motion)
{
  if (dt <= 0)
  {
    return;
  }
  measureJitter(dt, motion);
  const Matrix6 own = symmetricPart(motion.information.llt().solve(Matrix6::Identity()));
  // The estimate weighs points and prior by their information: its covariance has a part of each.
  const Matrix6 of_points =
      motion.converged() ? symmetricPart(own * in_map * own) : Matrix6(Matrix6::Zero());
  setCovariance(covarianceScale(options_.registration_covariance_scale, motion) * of_points,
                covarianceScale(options_.motion_covariance_scale, motion) * (own - of_points),
                motion);
}

void MotionUncertainty::calibrateMatch(double dt, const Matrix6& prior, MotionEstimate& motion)
{
  if (dt <= 0)
  {
    return;
  }
  measureJitter(dt, motion);
  const double scale = std::max(covarianceScale(options_.motion_covariance_scale, motion), 1e-6);
  Matrix6 information = prior;
  if (motion.converged() && motion.information.allFinite())
  {
    information += motion.information / scale;
  }
  setCovariance(Matrix6::Zero(), symmetricPart(information.llt().solve(Matrix6::Identity())),
                motion);
}

void MotionUncertainty::exchangeState(StateArchive& archive)
{
  archive(velocity_, acceleration_, jitter_, motions_, samples_, noise_before_);
}
}  // namespace dyslam
