// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/SmoothMotionFactor.h>

namespace dyslam
{
const FactorType SmoothMotionFactor::factor_type = {
    "smooth_motion",
    "SMOOTH_MOTION",
    nullptr,
    6,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(2);
      fields.object(data.keys[0].object);
      fields.index(data.keys[0].index);
      fields.index(data.keys[1].index);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<SmoothMotionFactor>(
          static_cast<int>(data.keys.at(0).object), static_cast<std::size_t>(data.keys.at(0).index),
          static_cast<std::size_t>(data.keys.at(1).index), data.information);
    }};

Vector6 SmoothMotionFactor::residual(ValueBlocks blocks, FactorJacobians* jacobians) const
{
  if (jacobians != nullptr)
  {
    (*jacobians)[0] = -Matrix6::Identity();
    (*jacobians)[1] = Matrix6::Identity();
  }
  return Eigen::Map<const Vector6>(blocks[1]) - Eigen::Map<const Vector6>(blocks[0]);
}
}  // namespace dyslam
