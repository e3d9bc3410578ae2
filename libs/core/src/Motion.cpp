// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Motion.h>

#include <Eigen/Cholesky>
#include <cmath>

namespace dyslam
{
void MotionPrior::fuse(const Pose& T_measured, const Matrix6& measured_information)
{
  const Vector6 difference = logSE3(T_previous_current.inverse() * T_measured);
  information += measured_information;
  T_previous_current =
      T_previous_current * expSE3(information.ldlt().solve(measured_information * difference));
}

double MotionPrior::mahalanobisDistance(const Pose& T_measured,
                                        double sigma,
                                        double sigma_angle) const
{
  Matrix6 covariance = information.llt().solve(Matrix6::Identity());
  covariance.diagonal().head<3>().array() += sigma * sigma;
  covariance.diagonal().tail<3>().array() += sigma_angle * sigma_angle;
  const Vector6 difference = logSE3(T_previous_current.inverse() * T_measured);
  return std::sqrt(difference.dot(covariance.llt().solve(difference)));
}

Matrix6 informationFromSigmas(double sigma, double sigma_angle)
{
  Vector6 diagonal;
  diagonal.head<3>().setConstant(1 / (sigma * sigma));
  diagonal.tail<3>().setConstant(1 / (sigma_angle * sigma_angle));
  return diagonal.asDiagonal();
}
}  // namespace dyslam
