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
/** What DyLO found between two scans. */
struct DyloMatch
{
  Pose T_reference_current = Pose::Identity();
  /** Of weighted point-to-plane residuals, per 1 m^2 of variance and for weights that sum to 1;
   * tangent [translation, rotation] on the right of the motion. Zero with the regression head. */
  Matrix6 normal_matrix = Matrix6::Zero();
  double rmse = 0;              //!< weighted, of the residuals [m]
  double effective_points = 0;  //!< 1 / sum of squared weights: how many share the say
  std::size_t sampled = 0;      //!< points of the current scan that were looked at
  std::size_t matched = 0;      //!< sampled points that found a surface
  std::size_t inliers = 0;      //!< of those, nearer than 0.15 m to it, farther off a little more
  double last_step = 0;         //!< how far the last pass still moved the pose [m + 10 m/rad]
};

/** A trained DyLO network, without torch in sight. Not thread-safe.
 *
 * Points have the sensor at the origin, x forward, z up [m]; invalid ones are passed over.
 */
class DyloMatcher
{
 public:
  /** \throws UserError if the file is missing, damaged or of another shape. */
  explicit DyloMatcher(const std::string& weights, int threads = 1);
  ~DyloMatcher();
  DyloMatcher(DyloMatcher&&) noexcept;
  DyloMatcher& operator=(DyloMatcher&&) noexcept;

  /** The scan becomes the current one. \return how many of its points the network can use.
   * \param phase when each point was measured, in shares of the motion since the scan before, from
   * the scan's own time; empty where a scan is not to be deskewed any further
   * \param T_sweep the motion, of the sensor, that the points were deskewed with */
  std::size_t setCurrent(const std::vector<Eigen::Vector3f>& points,
                         const std::vector<float>& phase = {},
                         const Pose& T_sweep = Pose::Identity());
  /** The current scan becomes the reference, deskewed by `T_sweep` if its motion was found. */
  void keepAsReference(const std::optional<Pose>& T_sweep = {});
  void forgetReference();

  /** Current scan against the reference; both must be set.
   * \param start of the search
   * \param deskew the reference is the scan before, so that what is found is the motion within the
   * current scan too: it is deskewed by that, and so is a reference whose own motion is unknown.
   * \param prior joins the points; none for null */
  [[nodiscard]] DyloMatch match(const Pose& start,
                                bool deskew = false,
                                const DyloPrior* prior = nullptr);

  /** Of the last match: how surely each point of the current scan stands still, in [0, 1]; in the
   * order of setCurrent(). Points that no sampled point speaks for get 1. */
  [[nodiscard]] std::vector<float> staticConfidence() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
