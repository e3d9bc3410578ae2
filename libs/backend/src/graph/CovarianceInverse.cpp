// SPDX-License-Identifier: BSD-3-Clause
#include "CovarianceInverse.h"

#include <Eigen/Dense>

namespace dyslam
{
Matrix6 informationFromCovariance(const Matrix6& covariance)
{
  const Matrix6 inverse = symmetricPart(covariance.inverse());
  if (inverse.allFinite() && inverse.llt().info() == Eigen::Success)
  {
    return inverse;
  }
  constexpr double least_share = 1e-13;  // of the largest variance; above rounding
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(symmetricPart(covariance));
  const Vector6& variances = solver.eigenvalues();
  return symmetricPart(
      solver.eigenvectors() *
      variances.cwiseMax(least_share * variances.maxCoeff()).cwiseInverse().asDiagonal() *
      solver.eigenvectors().transpose());
}
}  // namespace dyslam
