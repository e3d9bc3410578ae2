// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/mapping/HindsightLabels.h>

#include <Eigen/Core>
#include <vector>

#include "ClearVoxels.h"
#include "GroundPlanes.h"
#include "RecentScores.h"
#include "ScanWindow.h"
#include "Segments.h"
#include "VoxelClassifier.h"

namespace dyslam
{
/** Decides which points of a scan move, from the scans before and after it: the steps of
 * doc/labels.md. Points above the ground are grouped into voxels, voxels into segments; voxels are
 * classified, and lower points get the label of the voxels above them.
 *
 * Three results are kept from scan to scan: planes of the ground (GroundPlanes) and which voxels
 * were never observed free (ClearVoxels), to save time, and the scores of voxels (RecentScores), to
 * smooth them. */
class MovingPointClassifier
{
 public:
  /** \param options validated \param threads 0: as many as the machine has */
  MovingPointClassifier(const HindsightOptions& options, int threads);

  /** Sets `moving` and `moving_probability` of a frame, from their causal values, its cloud, its
   * objects and the other scans. \param window scans around the frame, which is the current one */
  void label(Frame& frame, const ScanWindow& window);

  void exchangeState(StateArchive& archive);

 private:
  /** The points of a scan. */
  struct Points
  {
    std::vector<Eigen::Vector3f> positions;  //!< odometry frame [m]
    std::vector<float> heights;              //!< heights over the ground [m]
  };

  [[nodiscard]] Segments segment(const Points& points) const;
  void addRayEvidence(const Frame& frame,
                      const ScanWindow& window,
                      const Points& points,
                      const Segments& segments,
                      std::vector<VoxelEvidence>& evidence);
  [[nodiscard]] static std::vector<VoxelFeatures> featuresOf(
      const Frame& frame,
      const Points& points,
      const std::vector<VoxelEvidence>& evidence,
      Segments& segments);
  [[nodiscard]] std::vector<float> classify(const Points& points,
                                            const Segments& segments,
                                            const std::vector<VoxelFeatures>& features);
  static void labelLowPoints(const ScanWindow& window,
                             const Points& points,
                             const Segments& segments,
                             const std::vector<float>& voxel_probability,
                             std::vector<float>& probability);

  HindsightOptions options_;
  ThreadPool pool_;
  GroundPlanes ground_planes_;
  ClearVoxels clear_voxels_;
  RecentScores recent_scores_;
};
}  // namespace dyslam
