// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

namespace dyslam
{
/** Residual log(T_measured^-1 T_a^-1 T_b) between two poses a and b: base class of odometry, loop
 * and observation factors. */
class RelativePoseFactor : public Factor
{
 public:
  /** \param type row of the derived class
   *  \param T_a_b pose of b in the frame of a
   *  \param information over the tangent of T_a_b, see Factor */
  RelativePoseFactor(const FactorType& type,
                     const Key& a,
                     const Key& b,
                     const Pose& T_a_b,
                     const Matrix6& information);

  [[nodiscard]] Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const override;
  [[nodiscard]] Pose measurement() const override { return T_a_b_; }

 private:
  Pose T_a_b_;
};
}  // namespace dyslam
