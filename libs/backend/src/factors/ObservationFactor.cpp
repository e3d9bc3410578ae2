// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/factors/ObservationFactor.h>

#include <stdexcept>

namespace dyslam
{
ObservationFactor::ObservationFactor(std::size_t keyframe,
                                     const Key& object,
                                     const Pose& T_vehicle_object,
                                     const Matrix6& information)
    : RelativePoseFactor(Key::ego(keyframe), object, T_vehicle_object, information)
{
  if (object.kind != VariableKind::static_object && object.kind != VariableKind::object_pose)
  {
    throw std::invalid_argument("observation of " + toString(object) + ": not an object's pose");
  }
}
}  // namespace dyslam
