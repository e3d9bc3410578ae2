// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

#include <memory>
#include <vector>

namespace dyslam
{
/** A factor of any kind as plain data; without keys: none. */
struct SavedFactor
{
  FactorKind kind = FactorKind::odometry;
  std::vector<Key> keys;
  Pose measurement = Pose::Identity();
  double dt = 0;                                      //!< of an object_motion [s]
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  //!< of a gnss [m]
  Matrix6 information = Matrix6::Zero();
};

[[nodiscard]] SavedFactor savedFrom(const Factor* factor);
/** The same factor again. \throws UserError for data that are no valid factor. */
[[nodiscard]] std::unique_ptr<const Factor> made(const SavedFactor& saved);
}  // namespace dyslam
