// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/core/NeighbourSearch.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dyslam
{
/** Shape of the neighbourhood of a point, in the frame of the points. */
struct LocalShape
{
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  //!< unit, towards the viewpoint; 0 if unknown
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();    //!< mean of the neighbours [m]
  Eigen::Vector3f spread = Eigen::Vector3f::Zero();  //!< sigmas of principal axes, ascending [m]

  [[nodiscard]] bool valid() const { return !normal.isZero(0); }
  /** Planarity in [0, 1]: 1 for a perfect plane, near 0 for a line or a blob. */
  [[nodiscard]] float planarity() const
  {
    return spread.z() > 0 ? (spread.y() - spread.x()) / spread.z() : 0.0F;
  }
};

/** Mean, normal and spread of a set of points; invalid for fewer than three or all on one line. */
[[nodiscard]] LocalShape fitLocalShape(const std::vector<Eigen::Vector3f>& points,
                                       const Eigen::Vector3f& viewpoint);

/** Shapes of all points from their k nearest neighbours (the point itself among them) within
 * `max_distance` [m]; normals point towards `viewpoint`. Points that are not finite get invalid
 * shapes.
 */
[[nodiscard]] std::vector<LocalShape> estimateNormals(const std::vector<Eigen::Vector3f>& points,
                                                      const KdTree& tree,
                                                      std::size_t k,
                                                      float max_distance,
                                                      const Eigen::Vector3f& viewpoint,
                                                      ThreadPool& pool);
}  // namespace dyslam
