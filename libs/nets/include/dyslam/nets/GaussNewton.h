// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/ScanTensors.h>

namespace dyslam
{
/** Solution of the symmetric positive definite 6x6 system A x = b, differentiable in both (double).
 */
[[nodiscard]] torch::Tensor solveSpd(const torch::Tensor& a, const torch::Tensor& b);

/** Rotation matrix of a rotation vector [3], differentiable. */
[[nodiscard]] torch::Tensor expRotation(const torch::Tensor& rotation);
/** Rotation matrix of a quaternion [4], w first, any length but 0. */
[[nodiscard]] torch::Tensor rotationOfQuaternion(const torch::Tensor& quaternion);

/** Planes and points that a pose step should bring together. */
struct Alignment
{
  torch::Tensor points;     //!< [N, 3] of scan 1, warped by the pose so far
  torch::Tensor normal;     //!< [N, 3]; shorter than 1 where candidates disagree
  torch::Tensor offset;     //!< [N]; residual = normal . point - offset
  torch::Tensor target;     //!< [N, 3] for the isotropic term
  torch::Tensor weight;     //!< [N], sums to 1
  torch::Tensor isotropic;  //!< weight of the point-to-point term; undefined for none
};

struct GaussNewtonStep
{
  PoseTensors update;           //!< to be put before the pose so far
  torch::Tensor normal_matrix;  //!< [6, 6] of the weighted terms, [translation, rotation]
};

/** One step, differentiable in every field of `alignment`. With no weight at all: the identity. */
[[nodiscard]] GaussNewtonStep gaussNewtonStep(const Alignment& alignment);

/** Unit eigenvector of the smallest eigenvalue and the square roots of all, of [N, 3, 3] symmetric
 * matrices. Not differentiable. */
struct PlaneFit
{
  torch::Tensor normal;  //!< [N, 3]
  torch::Tensor spread;  //!< [N, 3] ascending
};
[[nodiscard]] PlaneFit fitPlanes(const torch::Tensor& covariance);
}  // namespace dyslam
