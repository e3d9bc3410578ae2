// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/ScanTensors.h>

namespace dyslam
{
/** Solution of the symmetric positive definite 6x6 system A x = b (double), differentiable in A and
 * b.
 */
[[nodiscard]] torch::Tensor solveSpd(const torch::Tensor& a, const torch::Tensor& b);

/** Rotation matrix [3, 3] of a rotation vector [3] [rad], differentiable. */
[[nodiscard]] torch::Tensor expRotation(const torch::Tensor& rotation);
/** Rotation matrix [3, 3] of a quaternion [4] of non-zero norm, w first. */
[[nodiscard]] torch::Tensor rotationOfQuaternion(const torch::Tensor& quaternion);

/** Weighted point-to-plane correspondences, optionally with a point-to-point term. */
struct PoseStepProblem
{
  torch::Tensor points;     //!< [N, 3] points of scan 1, transformed by the current pose [m]
  torch::Tensor normal;     //!< [N, 3] plane normals; norm below 1 where candidates disagree
  torch::Tensor offset;     //!< [N] plane offsets: residual = normal . point - offset [m]
  torch::Tensor target;     //!< [N, 3] target points of the point-to-point term [m]
  torch::Tensor weight;     //!< [N] weights, sum 1
  torch::Tensor isotropic;  //!< relative weight of the point-to-point term; undefined for none
};

struct GaussNewtonStep
{
  PoseTensors update;           //!< left increment: the new pose is update * pose
  torch::Tensor normal_matrix;  //!< [6, 6] J^T W J, [translation, rotation]
};

/** One Gauss-Newton step, differentiable in each field of `problem`. Identity for zero weights. */
[[nodiscard]] GaussNewtonStep gaussNewtonStep(const PoseStepProblem& problem);

/** Eigenvector of the smallest eigenvalue and square roots of all eigenvalues of symmetric matrices
 * [N, 3, 3]. Not differentiable. */
struct PlaneFit
{
  torch::Tensor normal;  //!< [N, 3]
  torch::Tensor spread;  //!< [N, 3] standard deviations, ascending
};
[[nodiscard]] PlaneFit fitPlanes(const torch::Tensor& covariance);
}  // namespace dyslam
