// SPDX-License-Identifier: BSD-3-Clause
#include "EdgeError.h"

namespace dyslam
{
namespace
{
/** Coordinates of the error E and their derivative by x in E exp(x). */
Vector6 errorOf(ErrorCoordinates coordinates, const Pose& E, Matrix6* derivative)
{
  if (coordinates == ErrorCoordinates::log)
  {
    const Vector6 error = logSE3(E);
    if (derivative != nullptr)
    {
      *derivative = rightJacobianInverseSE3(error);
    }
    return error;
  }
  Vector6 error;
  error.head<3>() = E.translation();
  if (derivative != nullptr)
  {
    derivative->setZero();
    derivative->topLeftCorner<3, 3>() = E.linear();
  }
  if (coordinates == ErrorCoordinates::split_log)
  {
    error.tail<3>() = logSO3(E.linear());
    if (derivative != nullptr)
    {
      Vector6 rotation = Vector6::Zero();
      rotation.tail<3>() = error.tail<3>();
      derivative->bottomRightCorner<3, 3>() =
          rightJacobianInverseSE3(rotation).bottomRightCorner<3, 3>();
    }
    return error;
  }
  Eigen::Quaterniond q(E.linear());
  if (q.w() < 0)
  {
    q.coeffs() = -q.coeffs();
  }
  error.tail<3>() = 2 * q.vec();
  if (derivative != nullptr)
  {
    derivative->bottomRightCorner<3, 3>() = q.w() * Eigen::Matrix3d::Identity() + skew(q.vec());
  }
  return error;
}
}  // namespace

Vector6 edgeError(ErrorCoordinates coordinates,
                  const Pose& T_measured,
                  const Pose& T_i,
                  const Pose& T_j,
                  Matrix6* by_i,
                  Matrix6* by_j)
{
  const Pose T_i_j = T_i.inverse() * T_j;
  Matrix6 derivative;
  const bool wanted = by_i != nullptr || by_j != nullptr;
  const Vector6 error =
      errorOf(coordinates, T_measured.inverse() * T_i_j, wanted ? &derivative : nullptr);
  if (by_i != nullptr)
  {
    // T_i exp(x) moves E to E exp(-Ad(T_j^-1 T_i) x).
    by_i->noalias() = -derivative * adjointSE3(T_i_j.inverse());
  }
  if (by_j != nullptr)
  {
    *by_j = derivative;
  }
  return error;
}
}  // namespace dyslam
