// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <memory>

#include "EdgeError.h"
#include "GraphData.h"

namespace dyslam
{
/** A pose as Ceres moves it: translation, then quaternion x y z w. */
constexpr int pose_block_size = 7;
void packPose(const Pose& pose, double* block);
[[nodiscard]] Pose unpackPose(const double* block);

/** SE(3) with right-hand perturbations, T exp(x).
 *
 * Its "derivative of plus" is [I; 0]: cost functions on poses give their derivatives by x in the
 * first six columns and zero in the seventh, so that no chain rule through quaternions is needed.
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

/** Whitened error of one edge between two pose blocks. */
[[nodiscard]] std::unique_ptr<ceres::CostFunction> makeEdgeCost(ErrorCoordinates coordinates,
                                                                const GraphEdge& edge);

/** Whitened error (x, y, heading) of an edge of a planar graph between blocks (x, y, heading). */
[[nodiscard]] std::unique_ptr<ceres::CostFunction> makePlanarEdgeCost(const GraphEdge& edge);

/** Dynamic covariance scaling (Agarwal et al., ICRA 2013) as a loss: quadratic up to `width`, then
 * towards a constant. Its weight is min(1, 2 w^2 / (w^2 + s))^2. */
[[nodiscard]] std::unique_ptr<ceres::LossFunction> makeDcsLoss(double width);
}  // namespace dyslam
