// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace dyslam
{
/** Whether a matrix that was read from a file is a rotation, with a tolerance for text with few
 * digits and for float products. */
[[nodiscard]] inline bool isRotation(const Eigen::Matrix3d& R)
{
  constexpr double tolerance = 0.02;
  return (R * R.transpose()).isIdentity(tolerance) && R.determinant() > 0;
}
}  // namespace dyslam
