// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace dyslam
{
/** Counts of a static map against a reference labelled static or dynamic. */
struct MapScores
{
  std::size_t static_total = 0;      //!< number of static reference points or voxels
  std::size_t static_preserved = 0;  //!< number of static ones that the estimate has
  std::size_t dynamic_total = 0;     //!< number of dynamic reference points or voxels
  std::size_t dynamic_rejected = 0;  //!< number of dynamic ones that the estimate does not have
  std::size_t unlabelled = 0;        //!< reference points not counted: label 0 or 1, or non-finite

  /** Fraction in [0, 1]; nothing without static or dynamic reference points, respectively. */
  [[nodiscard]] std::optional<double> preservation() const;
  [[nodiscard]] std::optional<double> rejection() const;
};

/** Harmonic mean of the two: 2 a b / (a + b). Nothing if either is missing. */
[[nodiscard]] std::optional<double> harmonicMean(std::optional<double> a, std::optional<double> b);
/** Geometric mean of the two: sqrt(a b). Nothing if either is missing. */
[[nodiscard]] std::optional<double> geometricMean(std::optional<double> a, std::optional<double> b);

struct MapEvaluation
{
  /** Static accuracy SA and dynamic accuracy DA of the KTH dynamic-map benchmark: fractions of the
   * reference's points that have (static) or lack (dynamic) an estimated point within
   * `point_radius`. HA is their harmonic mean, AA their geometric mean. */
  MapScores points;
  /** Preservation PR and rejection RR of ERASOR: the same fractions of voxels of side
   * `voxel_size` on a grid through the map's origin; F1 is their harmonic mean. A voxel with
   * static and dynamic reference points is static. */
  MapScores voxels;
};

struct MapMetricsOptions
{
  double point_radius = 0.1;  //!< largest distance of an estimated point from a reference point [m]
  double voxel_size = 0.2;    //!< side of a voxel [m]
};

/** Evaluates a static map; non-finite points are ignored.
 * \param labels SemanticKITTI labels of the reference points (251-259 dynamic, 0 and 1 ignored)
 * \throws std::invalid_argument if labels and reference differ in length or an option is not
 * positive. */
[[nodiscard]] MapEvaluation evaluateMap(const std::vector<Eigen::Vector3f>& reference,
                                        const std::vector<std::uint32_t>& labels,
                                        const std::vector<Eigen::Vector3f>& estimate,
                                        const MapMetricsOptions& options = {});
}  // namespace dyslam
