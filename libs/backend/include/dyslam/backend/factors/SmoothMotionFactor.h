// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

namespace dyslam
{
/** Residual V_to - V_from: the velocity of an object changes slowly (o, Eq. 10). */
class SmoothMotionFactor final : public Factor
{
 public:
  static const FactorType factor_type;

  /** \param from, to indices of the scans at the end of two successive intervals */
  SmoothMotionFactor(int object, std::size_t from, std::size_t to, const Matrix6& information)
      : Factor(factor_type,
               {Key::objectVelocity(object, from), Key::objectVelocity(object, to)},
               information)
  {
  }

  [[nodiscard]] Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const override;
};
}  // namespace dyslam
