// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace dyslam
{
/** Scores of a static map against a reference whose points are labelled static or dynamic. */
struct MapScores
{
  std::size_t static_total = 0;      //!< static things in the reference (points or voxels)
  std::size_t static_preserved = 0;  //!< of them, still in the estimate
  std::size_t dynamic_total = 0;     //!< dynamic things in the reference
  std::size_t dynamic_rejected = 0;  //!< of them, gone from the estimate
  std::size_t unlabelled = 0;        //!< of the reference (0, 1, or not finite), left out

  /** Shares in [0, 1]; nothing where the reference has no such point. */
  [[nodiscard]] std::optional<double> preservation() const;
  [[nodiscard]] std::optional<double> rejection() const;
};

/** 2 a b / (a + b) and sqrt(a b): preservation and rejection in one figure. */
[[nodiscard]] std::optional<double> harmonicMean(std::optional<double> a, std::optional<double> b);
[[nodiscard]] std::optional<double> geometricMean(std::optional<double> a, std::optional<double> b);

struct MapEvaluation
{
  /** Static accuracy SA and dynamic accuracy DA of the KTH dynamic-map benchmark: shares of the
   * reference's points that have (static) or lack (dynamic) an estimated point within
   * `point_radius`. HA is their harmonic mean, AA the geometric one. */
  MapScores points;
  /** Preservation PR and rejection RR of ERASOR: the same shares counted in voxels of side
   * `voxel_size` on a grid through the map's origin; F1 is their harmonic mean. A voxel that holds
   * static and dynamic reference points counts as static. */
  MapScores voxels;
};

struct MapMetricsOptions
{
  double point_radius = 0.1;  //!< an estimated point this near stands for a reference point [m]
  double voxel_size = 0.2;    //!< [m]
};

/** \param labels one per reference point: SemanticKITTI labels (251-259 dynamic, 0 and 1 left out).
 * Points that are not finite are left out.
 * \throws std::invalid_argument if labels and reference differ in length or an option is not
 * positive. */
[[nodiscard]] MapEvaluation evaluateMap(const std::vector<Eigen::Vector3f>& reference,
                                        const std::vector<std::uint32_t>& labels,
                                        const std::vector<Eigen::Vector3f>& estimate,
                                        const MapMetricsOptions& options = {});
}  // namespace dyslam
