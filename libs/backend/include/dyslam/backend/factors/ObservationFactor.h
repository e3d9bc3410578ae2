// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/factors/RelativePoseFactor.h>

namespace dyslam
{
/** Pose of an object observed from a keyframe (z, Eq. 8); with robust loss. */
class ObservationFactor final : public RelativePoseFactor
{
 public:
  static const FactorType factor_type;

  /** \param object key of a static object or of an object pose
   *  \param T_vehicle_object pose of the object in the vehicle frame of the keyframe
   *  \throws std::invalid_argument for a key of another kind. */
  ObservationFactor(std::size_t keyframe,
                    const Key& object,
                    const Pose& T_vehicle_object,
                    const Matrix6& information);
  [[nodiscard]] FactorLoss loss(const FactorGraphOptions& options) const override;
};
}  // namespace dyslam
