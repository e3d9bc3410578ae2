// SPDX-License-Identifier: BSD-3-Clause
// Includes torch.
#pragma once

#include <dyslam/nets/BevOps.h>
#include <dyslam/nets/DysegNet.h>

#include <vector>

namespace dyslam
{
/** Flow of a rigid motion at some positions, N x 2 [m]. */
[[nodiscard]] torch::Tensor rigidFlow(const PlanarMotion& motion,
                                      const std::vector<Eigen::Vector2f>& positions);

/** Fits the static motion (current to past) to the correlation of two encodings. No gradients reach
 * the motion. */
class StaticMotionMatcher
{
 public:
  /** \param past middle features of the past scan \param radius radius of the windows [cells]. All
   * arguments must outlive the object. */
  StaticMotionMatcher(const BevScan& scan,
                      const DysegEncoding& current,
                      const SparseMap& past,
                      int radius);

  /** Correlation at 1/4, N x (2r+1)^2, with the windows centred at a motion. */
  [[nodiscard]] torch::Tensor correlationAround(const PlanarMotion& motion) const;

  /** Searches all motions: at 1/8 (`coarse_correlation`, around zero motion), then at 1/4.
   * \param[out] margin MotionSearchResult::margin of the search at 1/8 */
  [[nodiscard]] PlanarMotion search(const torch::Tensor& coarse_correlation, double& margin) const;

  /** Refines a motion at 1/4 by repeated robust fits to the correlation's peaks. Without cells that
   * may be static, the result is `initial`, not converged. \param start_width initial width of the
   * robust loss [m] */
  [[nodiscard]] RigidFlowFit refine(const PlanarMotion& initial, double start_width) const;

 private:
  /** Cells at 1/4 that may be static and are near enough to vote. */
  struct Voters
  {
    std::vector<Eigen::Vector2f> centre;  //!< centre of each cell [m]
    std::vector<float> weight;            //!< static weight of each cell
    torch::Tensor features;               //!< features of the current scan, a row per cell
    torch::Tensor position;               //!< position (x, y), a row per cell [cells]
  };
  [[nodiscard]] Voters voters() const;
  [[nodiscard]] RigidFlowFit fitPeaks(const Voters& voters,
                                      const PlanarMotion& centre,
                                      double start_width) const;

  const DysegEncoding& current_;
  const DysegCells& cells_;
  const SparseMap& past_;
  int radius_;
  float cell_size_;              //!< side of the cells at 1/4 [m]
  torch::Tensor static_weight_;  //!< N: weight of each cell at 1/4
};
}  // namespace dyslam
