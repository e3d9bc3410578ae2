// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace dyslam
{
/** Height that no vehicle exceeds: higher objects are certainly static [m]. */
constexpr float vehicle_height = 5;
/** Length that hardly any vehicle exceeds [m]. */
constexpr float vehicle_length = 20;
/** Width that no vehicle, nor a group of people who walk together, reaches [m]. */
constexpr float vehicle_width = 4;

/** Evidence of a voxel, of its neighbours, or of a segment: means over voxels. */
struct VoxelEvidence
{
  float known = 0;          //!< share of voxels observed by rays of other scans
  float free = 0;           //!< share of the observing rays that passed through
  float change_before = 0;  //!< confidence that the voxel was free before, in [0, 1]
  float change_after = 0;   //!< confidence that the voxel is free afterwards, in [0, 1]
  float probability = 0;    //!< causal moving probability, mean over the points
  float tracked = 0;        //!< share of points in a track that is dynamic at any time
};

/** Features of one voxel for the decision whether its points move. */
struct VoxelFeatures
{
  std::uint32_t point = 0;  //!< first point of the voxel, index in the cloud
  VoxelEvidence own;
  VoxelEvidence around;      //!< evidence of its cell and the cells that touch it
  VoxelEvidence segment;     //!< evidence of the segment it belongs to
  float height = 0;          //!< height of the point over the ground [m]
  float range = 0;           //!< distance of the point from the vehicle [m]
  float length = 0;          //!< larger extent of the segment along x or y (odometry frame) [m]
  float segment_height = 0;  //!< extent of the segment along z [m]
  float row_length = 0;      //!< length and width of a rectangle with the segment's horizontal
  float row_width = 0;       //!< covariance: about 0 wide if the segment is a straight row [m]
  float voxels = 0;          //!< number of voxels of the segment
  float doubt = 0;           //!< how doubtful free rays are in this scan, in [0, 1]
};

/** Corrects the share of free rays for the share that static objects show in this scan. \param
 * false_free share of free rays at voxels of static objects, below 0.5 */
void discount(VoxelEvidence& evidence, float false_free);

/** Log odds that the voxel moves. */
[[nodiscard]] float movingScore(const VoxelFeatures& features);
}  // namespace dyslam
