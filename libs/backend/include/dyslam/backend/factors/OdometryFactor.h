// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/factors/RelativePoseFactor.h>

namespace dyslam
{
/** Motion between two keyframes, measured by the odometry (f, Eq. 6). */
class OdometryFactor final : public RelativePoseFactor
{
 public:
  static const FactorType factor_type;

  /** \param T_from_to pose of keyframe `to` in keyframe `from` */
  OdometryFactor(std::size_t from,
                 std::size_t to,
                 const Pose& T_from_to,
                 const Matrix6& information)
      : RelativePoseFactor(factor_type, Key::ego(from), Key::ego(to), T_from_to, information)
  {
  }
};
}  // namespace dyslam
