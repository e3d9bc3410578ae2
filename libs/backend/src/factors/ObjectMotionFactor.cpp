// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/factors/ObjectMotionFactor.h>

#include <cmath>
#include <stdexcept>

#include "graph/EdgeError.h"

namespace dyslam
{
ObjectMotionFactor::ObjectMotionFactor(
    int object, std::size_t from, std::size_t to, double dt, const Matrix6& information)
    : Factor({Key::objectPose(object, from), Key::objectPose(object, to),
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
}  // namespace dyslam
