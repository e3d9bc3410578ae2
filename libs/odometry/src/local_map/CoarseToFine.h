// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/odometry/RefineOptions.h>

#include <vector>

#include "ScanToMap.h"

namespace dyslam
{
/** A scan to be aligned with a local map. */
struct AlignmentProblem
{
  const RawPoints& points;
  const std::vector<Eigen::Matrix3f>& covariances;  //!< as in ScanToMap::align()
  Pose T_odom_previous;                             //!< pose of the scan before
  ScanToMapSettings settings;  //!< in the map's own cells; start_loss_width is not used
};

/** Registration of a scan to a local map, first to coarser cells where the initial guess may be
 * wrong by more than the map's cells. Keeps its working memory. */
class CoarseToFine
{
 public:
  CoarseToFine(const RefineOptions& options, ThreadPool& pool)
      : options_(options), registration_(pool)
  {
  }

  /** \param guess_error expected error of the guess [m]
   * \param usual_inliers inlier share of the scans before; if this one's is much lower, the
   *   registration is repeated coarse to fine, and the better result taken; 0: it is not */
  [[nodiscard]] ScanToMapResult align(const AlignmentProblem& problem,
                                      const SurfacePyramid& map,
                                      const Pose& T_odom_vehicle_guess,
                                      double guess_error,
                                      double usual_inliers);
  /** In the map's own cells only.
   * \param guess_error expected error of the guess [m] */
  [[nodiscard]] ScanToMapResult alignFine(const AlignmentProblem& problem,
                                          const SurfacePyramid& map,
                                          const Pose& T_odom_vehicle_guess,
                                          double guess_error);
  /** Initial width of the robust loss in the map's own cells [m].
   * \param guess_error expected error of the guess [m] */
  [[nodiscard]] double startLossWidth(double guess_error) const;

 private:
  /** First in cells `coarseness` times as large, then halved step by step. */
  [[nodiscard]] ScanToMapResult alignFrom(int coarseness,
                                          const AlignmentProblem& problem,
                                          const SurfacePyramid& map,
                                          const Pose& T_guess);

  RefineOptions options_;
  ScanToMap registration_;
};
}  // namespace dyslam
