// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/factors/RelativePoseFactor.h>

#include <stdexcept>

#include "graph/EdgeError.h"

namespace dyslam
{
RelativePoseFactor::RelativePoseFactor(const FactorType& type,
                                       const Key& a,
                                       const Key& b,
                                       const Pose& T_a_b,
                                       const Matrix6& information)
    : Factor(type, {a, b}, information), T_a_b_(T_a_b)
{
  if (!T_a_b.matrix().allFinite())
  {
    throw std::invalid_argument("factor " + toString(a) + " -> " + toString(b) +
                                ": its measurement has numbers that are not finite");
  }
}

void RelativePoseFactor::exchangeKeyframes(FactorData& data, FactorFields& fields)
{
  data.keys.resize(2);
  fields.index(data.keys[0].index);
  fields.index(data.keys[1].index);
  fields.pose(data.measurement);
}

Vector6 RelativePoseFactor::residual(ValueBlocks blocks, FactorJacobians* jacobians) const
{
  return edgeError(ErrorCoordinates::log, T_a_b_, unpackPose(blocks[0]), unpackPose(blocks[1]),
                   jacobians != nullptr ? &(*jacobians)[0] : nullptr,
                   jacobians != nullptr ? &(*jacobians)[1] : nullptr);
}
}  // namespace dyslam
