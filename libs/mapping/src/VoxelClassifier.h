// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace dyslam
{
/** No vehicle is higher: what is, is certainly static [m]. */
constexpr float vehicle_height = 5;

/** Evidence of a voxel, of its neighbours, or of a segment: means over voxels. */
struct VoxelEvidence
{
  float known = 0;          //!< share of voxels observed by rays of other scans
  float free = 0;           //!< of these rays, the share that passed through
  float change_before = 0;  //!< confidence that it was free before it was occupied, in [0, 1]
  float change_after = 0;   //!< confidence that it is free afterwards, in [0, 1]
  float probability = 0;    //!< moving probability of the points, causal
  float tracked = 0;        //!< share of points in a track that is dynamic at one time
};

/** Features of one voxel for the decision whether its points move. */
struct VoxelFeatures
{
  std::uint32_t point = 0;  //!< one of its points, position in the cloud
  VoxelEvidence own;
  VoxelEvidence around;      //!< of the cells that touch it
  VoxelEvidence segment;     //!< of the segment it belongs to
  float height = 0;          //!< over the ground [m]
  float length = 0;          //!< of the segment along x or y of the odometry frame, the longer [m]
  float segment_height = 0;  //!< of the segment from bottom to top [m]
  float voxels = 0;          //!< number of those of the segment
  float doubt = 0;           //!< how doubtful free rays are in this scan, in [0, 1]
};

/** Lowers the shares of free rays by that of static objects in this scan. \param false_free share
 * of the rays through their voxels that passed, below 0.5. */
void discount(VoxelEvidence& evidence, float false_free);

/** Log odds that the voxel moves. */
[[nodiscard]] float movingScore(const VoxelFeatures& features);
}  // namespace dyslam
