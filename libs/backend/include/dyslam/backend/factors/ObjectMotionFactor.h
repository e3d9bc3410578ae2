// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

#include <vector>

namespace dyslam
{
/** log(l_from^-1 l_to) - V_to dt: a moving object follows its velocity (m, Eq. 9). */
class ObjectMotionFactor final : public Factor
{
 public:
  static const FactorType factor_type;

  /** \param object id of the object
   *  \param from, to indices of the scans, in order of time
   *  \param dt time between the scans [s], above 0
   *  \throws std::invalid_argument for another dt. */
  ObjectMotionFactor(
      int object, std::size_t from, std::size_t to, double dt, const Matrix6& information);

  [[nodiscard]] Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const override;
  [[nodiscard]] FactorData data() const override;
  [[nodiscard]] double dt() const { return dt_; }

 private:
  double dt_;
};
}  // namespace dyslam
