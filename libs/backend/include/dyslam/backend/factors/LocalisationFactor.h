// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/factors/RelativePoseFactor.h>

namespace dyslam
{
/** Pose of a keyframe in the prior map, measured by registration to it; with the robust loss of
 * loops, since places may look alike or have changed. */
class LocalisationFactor final : public RelativePoseFactor
{
 public:
  static const FactorType factor_type;

  /** \param T_prior_vehicle pose of the vehicle at the keyframe, frame of the prior map
   * \param prior_map variable of the prior map */
  LocalisationFactor(std::size_t keyframe,
                     const Pose& T_prior_vehicle,
                     const Matrix6& information,
                     const Key& prior_map = Key::priorMap())
      : RelativePoseFactor(factor_type, prior_map, Key::ego(keyframe), T_prior_vehicle, information)
  {
  }
  [[nodiscard]] FactorLoss loss(const FactorGraphOptions& options) const override;
};
}  // namespace dyslam
