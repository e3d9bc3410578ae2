// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/factors/SmoothMotionFactor.h>

namespace dyslam
{
Vector6 SmoothMotionFactor::residual(ValueBlocks blocks, FactorJacobians* jacobians) const
{
  if (jacobians != nullptr)
  {
    (*jacobians)[0] = -Matrix6::Identity();
    (*jacobians)[1] = Matrix6::Identity();
  }
  return Eigen::Map<const Vector6>(blocks[1]) - Eigen::Map<const Vector6>(blocks[0]);
}
}  // namespace dyslam
