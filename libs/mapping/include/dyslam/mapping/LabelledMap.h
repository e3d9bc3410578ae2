// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Labels.h>
#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** Every point of a recording with its true label, one per cube of 0.1 m: the reference of map
 * metrics. Not thread-safe. */
class LabelledMap
{
 public:
  /** Adds a scan at `T_odom_vehicle`. Points in the boxes of `dynamic` objects (odometry frame,
   * too) move, except those near the ground of a box. \param labels one per point of the cloud, or
   * empty: all static; points without a valid label are left out \throws std::invalid_argument for
   * another number of labels */
  void add(const Frame& frame, const std::vector<Label>& labels);

  /** First point of each cube, odometry frame of the scans [m]. */
  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }
  /** One label per point of points(); a cube that ever held a static point is static. */
  [[nodiscard]] const std::vector<Label>& labels() const { return labels_; }

 private:
  std::vector<Eigen::Vector3f> points_;
  std::vector<Label> labels_;
  VoxelHash index_;
};
}  // namespace dyslam
