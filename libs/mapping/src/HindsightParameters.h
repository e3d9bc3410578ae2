// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace dyslam
{
/** Fixed parameters of the labels with hindsight, besides HindsightOptions. Parameters of a single
 * step are in its own file: rays (RayHistory.cpp, VisibilityImage.cpp), ground (GroundHeights.cpp),
 * posts (Posts.cpp), score (VoxelClassifier.cpp, VoxelFeatures.cpp), smoothing over time
 * (RecentScores.cpp, ClearVoxels.h). */
namespace hindsight
{
// ScanWindow: which other scans show whether a voxel was free, and where the ground is.

/** Steps between the scans of the window that are used grow with their distance to the scan that is
 * decided, from 1 to this many scans. */
constexpr int largest_step = 5;
/** Distance between the scans before the window that are kept [scans]. */
constexpr int earlier_step = 8;
/** Least ratio of the distances of two successive scans before the window that are used. */
constexpr double earlier_growth = 1.1;
/** Steps between the scans of the window that show the ground [scans]. */
constexpr std::size_t ground_step = 5;

// MovingPointClassifier: evidence.

/** Causal moving probability above which a voxel may be moving: all rays are evaluated there. */
constexpr float suspicious_probability = 0.1F;
/** Number of scans by which a change of a voxel between free and occupied is certain. */
constexpr float certain_change = 3;

// MovingPointClassifier: segments.

/** VoxelFeatures::doubt from which on segments larger than a vehicle are not divided: 0.05 % of the
 * rays at voxels of high static objects passed through. */
constexpr float doubt_of_division = 0.005F;

// MovingPointClassifier: score.

/** Score above which a voxel may be moving, so that it matters whether it is a post [log odds]. */
constexpr float doubtful_score = -2;
/** Amount by which the score of a post's voxels is lowered [log odds]. */
constexpr float post_score = 2.5F;

// MovingPointClassifier: low points, which are below HindsightOptions::ground_clearance.

/** Height over the ground of the square of 2 m up to which a point is ground [m]. */
constexpr float lowest_over_square = 0.1F;
/** Height over the ground of the square of 0.5 m up to which a point is ground [m]. */
constexpr float lowest_over_fine_square = 0.05F;
/** Number of cells (HindsightOptions::segment_gap), from that of a low point upwards, which decide
 * whether it moves. */
constexpr int cells_above = 3;
}  // namespace hindsight
}  // namespace dyslam
