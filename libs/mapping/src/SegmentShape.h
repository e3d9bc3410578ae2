// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "Segments.h"

namespace dyslam
{
/** Shape of a segment: extents of its voxels, along the axes of the odometry frame and of a
 * horizontal rectangle with the same covariance. */
struct SegmentShape
{
  float length = 0;      //!< larger extent along x or y [m]
  float height = 0;      //!< extent along z [m]
  float row_length = 0;  //!< longer side of the rectangle [m]
  float row_width = 0;   //!< shorter side: about 0 if the segment is a straight row [m]
};

/** One shape per segment. \param points odometry frame [m] */
[[nodiscard]] std::vector<SegmentShape> segmentShapes(const Segments& segments,
                                                      const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
