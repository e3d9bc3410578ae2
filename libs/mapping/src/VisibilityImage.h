// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** How far one scan's rays went in every direction: nearest return per pixel. */
class VisibilityImage
{
 public:
  /** \param points returns and \param sensor the lidar's origin, both in the vehicle frame. */
  VisibilityImage(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& sensor);

  /** True if every ray near the direction of a cube of side `size` at `p` (vehicle frame) ended
   * more than `margin` behind it, and there were such rays. Directions without a return (sky,
   * black cars) prove nothing. */
  [[nodiscard]] bool observesFree(const Eigen::Vector3f& p, float size, float margin) const;

 private:
  static constexpr int cols = 900;
  static constexpr int rows = 180;

  Eigen::Vector3f sensor_;
  std::vector<float> range_;  // row-major, infinity where no ray returned
};
}  // namespace dyslam
