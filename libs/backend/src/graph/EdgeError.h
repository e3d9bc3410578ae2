// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

namespace dyslam
{
/** Coordinates of E = T_measured^-1 T_i^-1 T_j, six numbers [translation, rotation]. */
enum class ErrorCoordinates
{
  log,         //!< log(E) of SE(3)
  split_log,   //!< translation of E, log of its rotation: as g2o for EDGE_SE2
  quaternion,  //!< translation of E, twice the quaternion's vector part: as g2o for EDGE_SE3:QUAT
};

/** The error of an edge and, unless null, its derivatives by right-hand perturbations
 * T_i exp(x_i) and T_j exp(x_j). */
Vector6 edgeError(ErrorCoordinates coordinates,
                  const Pose& T_measured,
                  const Pose& T_i,
                  const Pose& T_j,
                  Matrix6* by_i = nullptr,
                  Matrix6* by_j = nullptr);
}  // namespace dyslam
