// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/ObservationFactor.h>

#include <stdexcept>

namespace dyslam
{
const FactorType ObservationFactor::factor_type = {
    "observation",
    "OBSERVATION",
    nullptr,
    6,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(2);
      fields.index(data.keys[0].index);
      fields.key(data.keys[1]);
      fields.pose(data.measurement);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<ObservationFactor>(static_cast<std::size_t>(data.keys.at(0).index),
                                                 data.keys.at(1), data.measurement,
                                                 data.information);
    }};

ObservationFactor::ObservationFactor(std::size_t keyframe,
                                     const Key& object,
                                     const Pose& T_vehicle_object,
                                     const Matrix6& information)
    : RelativePoseFactor(factor_type, Key::ego(keyframe), object, T_vehicle_object, information)
{
  if (object.kind != VariableKind::static_object && object.kind != VariableKind::object_pose)
  {
    throw std::invalid_argument("observation of " + toString(object) + ": not an object's pose");
  }
}

FactorLoss ObservationFactor::loss(const FactorGraphOptions& options) const
{
  return {options.object_loss, options.object_loss_width};
}
}  // namespace dyslam
