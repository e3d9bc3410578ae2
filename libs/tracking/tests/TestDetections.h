// SPDX-License-Identifier: BSD-3-Clause
// Detections of one car, for tests of the tracker.
#pragma once

#include <dyslam/core/Objects.h>

#include <Eigen/Core>

namespace dyslam::test
{
inline constexpr double dt = 0.1;  //!< between scans [s]

inline Detection carAt(const Eigen::Vector2d& position, double yaw = 0)
{
  Detection detection;
  detection.box.centre = {position.x(), position.y(), -0.8};
  detection.box.size = {4.2, 1.8, 1.5};
  detection.box.yaw = yaw;
  detection.object_class = ObjectClass::car;
  detection.covariance = Eigen::Vector4d(0.01, 0.01, 0.01, 0.01).asDiagonal();
  return detection;
}

/** The same as a cluster of points. */
inline Detection clusterAt(const Eigen::Vector2d& position, double yaw = 0)
{
  Detection detection = carAt(position, yaw);
  detection.points = {0, 1, 2};
  return detection;
}
}  // namespace dyslam::test
