// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "Segments.h"
#include "VoxelClassifier.h"

namespace dyslam
{
/** Makes the parts of large segments that changed segments of their own: whoever walks along a wall
 * touches it, so both are one segment of the size of a building, whose evidence says nothing about
 * the person. Applies to segments larger than a vehicle; a part consists of touching cells that
 * were free before or are free afterwards. \param evidence one value per voxel \param points
 * odometry frame [m] \param[in,out] segments gets further segments, numbered after the others
 * \return whether there are any */
bool divideLargeSegments(const std::vector<VoxelEvidence>& evidence,
                         const std::vector<Eigen::Vector3f>& points,
                         Segments& segments);
}  // namespace dyslam
