// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>
#include <dyslam/backend/FactorType.h>

#include <cstddef>
#include <memory>

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

 protected:
  /** FactorType::exchangeFields and make of a type between the ego poses of two keyframes: their
   * numbers and the measured pose. */
  static void exchangeKeyframes(FactorData& data, FactorFields& fields);
  template <typename T>
  [[nodiscard]] static std::unique_ptr<const Factor> makeOfKeyframes(const FactorData& data)
  {
    return std::make_unique<T>(static_cast<std::size_t>(data.keys.at(0).index),
                               static_cast<std::size_t>(data.keys.at(1).index), data.measurement,
                               data.information);
  }

 private:
  Pose T_a_b_;
};
}  // namespace dyslam
