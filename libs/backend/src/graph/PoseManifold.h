// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>
#include <dyslam/backend/Factor.h>

namespace dyslam
{
/** SE(3) with right-hand perturbations, T exp(x).
 *
 * PlusJacobian() is [I; 0]: cost functions on poses return their derivatives by x in the first six
 * columns and zero in the seventh, so that no chain rule through quaternions is needed.
 */
class PoseManifold final : public ceres::Manifold
{
 public:
  [[nodiscard]] int AmbientSize() const override { return pose_block_size; }
  [[nodiscard]] int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};
}  // namespace dyslam
