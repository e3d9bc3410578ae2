// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/nets/DyloPrior.h>

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Result of matching two scans with DyLO. */
struct DyloMatch
{
  Pose T_reference_current = Pose::Identity();
  /** Normal matrix J^T W J of the point-to-plane residuals, for weights that sum to 1 [1/m^2];
   * tangent [translation, rotation], perturbation on the right of T_reference_current. Zero with
   * the regression head. */
  Matrix6 normal_matrix = Matrix6::Zero();
  double rmse = 0;              //!< weighted RMS residual [m]
  double effective_points = 0;  //!< effective sample size, 1 / sum of squared weights
  std::size_t sampled = 0;      //!< sampled points of the current scan
  std::size_t matched = 0;      //!< sampled points with a correspondence
  std::size_t inliers = 0;      //!< matched points with a residual below 0.15 m + 0.005 * range
  double last_step = 0;         //!< size of the last iteration's step, motionSize() [m]
};

/** Scan-to-scan matching with a trained DyLO network; free of torch headers. Not thread-safe.
 *
 * Points are in the sensor frame, x forward, z up [m]; invalid ones are ignored.
 */
class DyloMatcher
{
 public:
  /** \param weights file of saveDylo() \param threads of the CPU; 0: one per core
   * \throws UserError if the file is missing, damaged or of another shape. */
  explicit DyloMatcher(const std::string& weights, int threads = 1);
  ~DyloMatcher();
  DyloMatcher(DyloMatcher&&) noexcept;
  DyloMatcher& operator=(DyloMatcher&&) noexcept;

  /** Encodes a scan as the current one. \return the number of points that the network can use.
   * \param phase acquisition time of each point relative to the scan's stamp, as a fraction of the
   * scan period; empty if the scan is not to be deskewed further
   * \param T_sweep motion of the sensor over one scan period with which the points were deskewed
   * \param phase_unit the scan period [s]; 0: a revolution of unknown duration */
  std::size_t setCurrent(const std::vector<Eigen::Vector3f>& points,
                         const std::vector<float>& phase = {},
                         const Pose& T_sweep = Pose::Identity(),
                         double phase_unit = 0);
  /** Makes the current scan the reference; re-deskews it by `T_sweep` if its motion is known. */
  void keepAsReference(const std::optional<Pose>& T_sweep = {});
  /** Saves or restores the reference; its encoding is computed again when it is restored. */
  void exchangeState(StateArchive& archive);

  /** Estimates the pose of the current scan in the frame of the reference; both must be set.
   * \param start initial guess
   * \param deskew the reference is the preceding scan, so that the estimate is also the motion
   * within the current scan: the current scan is re-deskewed by it, and so is a reference whose own
   * motion is unknown
   * \param prior fused with the points' normal equations; null for none */
  [[nodiscard]] DyloMatch match(const Pose& start,
                                bool deskew = false,
                                const DyloPrior* prior = nullptr);

  /** Static confidence of each point of the current scan in the last match, in [0, 1], in the order
   * of setCurrent(). Interpolated from the sampled points; 1 for points without a sample nearby. */
  [[nodiscard]] std::vector<float> staticConfidence() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
