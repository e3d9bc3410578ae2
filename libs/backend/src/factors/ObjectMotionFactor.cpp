// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/ObjectMotionFactor.h>

#include <cmath>
#include <stdexcept>

#include "graph/EdgeError.h"

namespace dyslam
{
const FactorType ObjectMotionFactor::factor_type = {
    "object_motion",
    "OBJECT_MOTION",
    nullptr,
    6,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(3);
      fields.object(data.keys[0].object);
      fields.index(data.keys[0].index);
      fields.index(data.keys[1].index);
      fields.number(data.further[0]);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<ObjectMotionFactor>(
          static_cast<int>(data.keys.at(0).object), static_cast<std::size_t>(data.keys.at(0).index),
          static_cast<std::size_t>(data.keys.at(1).index), data.further[0], data.information);
    }};

ObjectMotionFactor::ObjectMotionFactor(
    int object, std::size_t from, std::size_t to, double dt, const Matrix6& information)
    : Factor(factor_type,
             {Key::objectPose(object, from), Key::objectPose(object, to),
              Key::objectVelocity(object, to)},
             information),
      dt_(dt)
{
  if (!(dt > 0) || !std::isfinite(dt))
  {
    throw std::invalid_argument("motion of " + toString(keys()[1]) +
                                ": its time step must be above 0 and finite");
  }
}

Vector6 ObjectMotionFactor::residual(ValueBlocks blocks, FactorJacobians* jacobians) const
{
  const Eigen::Map<const Vector6> velocity(blocks[2]);
  const Vector6 motion =
      edgeError(ErrorCoordinates::log, Pose::Identity(), unpackPose(blocks[0]),
                unpackPose(blocks[1]), jacobians != nullptr ? &(*jacobians)[0] : nullptr,
                jacobians != nullptr ? &(*jacobians)[1] : nullptr);
  if (jacobians != nullptr)
  {
    (*jacobians)[2] = -dt_ * Matrix6::Identity();
  }
  return motion - dt_ * velocity;
}

FactorData ObjectMotionFactor::data() const
{
  FactorData data = Factor::data();
  data.further[0] = dt_;
  return data;
}
}  // namespace dyslam
