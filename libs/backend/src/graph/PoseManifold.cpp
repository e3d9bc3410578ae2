// SPDX-License-Identifier: BSD-3-Clause
#include "PoseManifold.h"

namespace dyslam
{
bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const
{
  const Eigen::Map<const Vector6> tangent(delta);
  const Pose step = expSE3(tangent);
  const Eigen::Map<const Eigen::Quaterniond> q(x + 3);
  const Eigen::Quaterniond turned = q * Eigen::Quaterniond(step.linear());
  const Eigen::Vector3d moved = Eigen::Map<const Eigen::Vector3d>(x) + q * step.translation();
  Eigen::Map<Eigen::Vector3d>{x_plus_delta} = moved;
  Eigen::Map<Eigen::Quaterniond>{x_plus_delta + 3} = turned.normalized();
  return true;
}

bool PoseManifold::PlusJacobian(const double* /*x*/, double* jacobian) const
{
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const
{
  Eigen::Map<Vector6>{y_minus_x} = logSE3(unpackPose(x).inverse() * unpackPose(y));
  return true;
}

bool PoseManifold::MinusJacobian(const double* /*x*/, double* jacobian) const
{
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}
}  // namespace dyslam
