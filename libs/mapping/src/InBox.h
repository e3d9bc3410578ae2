// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <cmath>

namespace dyslam
{
/** Whether a point lies in a box of the same frame that is widened to each side by `margin`, along
 * its length, width and height [m]. */
inline bool isInBox(const Box& box, const Eigen::Vector3d& p, const Eigen::Vector3d& margin)
{
  const Eigen::Vector3d d = p - box.center;
  const double along = std::cos(box.yaw) * d.x() + std::sin(box.yaw) * d.y();
  const double across = -std::sin(box.yaw) * d.x() + std::cos(box.yaw) * d.y();
  return std::abs(along) <= 0.5 * box.size.x() + margin.x() &&
         std::abs(across) <= 0.5 * box.size.y() + margin.y() &&
         std::abs(d.z()) <= 0.5 * box.size.z() + margin.z();
}
}  // namespace dyslam
