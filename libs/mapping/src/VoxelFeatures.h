// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "Segments.h"
#include "VoxelClassifier.h"

namespace dyslam
{
/** The features of every voxel of a scan: the evidence of the voxel itself, of its neighbours and
 * of its segment. \param evidence one value per voxel \param points of the scan, odometry frame [m]
 * \param heights heights over the ground, one per point [m] \param vehicle position of the vehicle,
 * odometry frame [m] */
[[nodiscard]] std::vector<VoxelFeatures> voxelFeatures(const Segments& segments,
                                                       const std::vector<VoxelEvidence>& evidence,
                                                       const std::vector<Eigen::Vector3f>& points,
                                                       const std::vector<float>& heights,
                                                       const Eigen::Vector3f& vehicle);
}  // namespace dyslam
