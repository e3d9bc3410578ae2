// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

#include <memory>
#include <vector>

namespace dyslam
{
/** A factor of any kind as plain data; no factor if it has no keys. */
struct SavedFactor
{
  FactorKind kind = FactorKind::odometry;
  std::vector<Key> keys;
  Pose measurement = Pose::Identity();
  double dt = 0;                                      //!< object_motion: time between the poses [s]
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  //!< gnss: antenna, vehicle frame [m]
  Eigen::Vector3d upwards = Eigen::Vector3d::Zero();  //!< gravity: specific force [m/s^2]
  Matrix6 information = Matrix6::Zero();
};

[[nodiscard]] SavedFactor savedFrom(const Factor* factor);
/** Restores a factor. \throws UserError for data that are no valid factor. */
[[nodiscard]] std::unique_ptr<const Factor> made(const SavedFactor& saved);
}  // namespace dyslam
