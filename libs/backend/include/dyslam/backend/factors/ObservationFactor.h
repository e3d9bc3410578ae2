// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/factors/RelativePoseFactor.h>

namespace dyslam
{
/** An object, standing or moving, as it was seen from a keyframe (z, Eq. 8); robust. */
class ObservationFactor final : public RelativePoseFactor
{
 public:
  /** \param object a static object or an object pose
   *  \param T_vehicle_object its pose in the vehicle frame of the keyframe
   *  \throws std::invalid_argument for a key of another kind. */
  ObservationFactor(std::size_t keyframe,
                    const Key& object,
                    const Pose& T_vehicle_object,
                    const Matrix6& information);
  [[nodiscard]] FactorKind kind() const override { return FactorKind::observation; }
};
}  // namespace dyslam
