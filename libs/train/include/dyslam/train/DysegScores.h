// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/DysegModel.h>
#include <dyslam/train/DysegData.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace dyslam
{
/** Sums from which the scores of moving-object segmentation and flow come. */
struct DysegScores
{
  std::uint64_t true_positives = 0;   //!< moving points, predicted moving
  std::uint64_t false_positives = 0;  //!< static points, predicted moving
  std::uint64_t false_negatives = 0;  //!< moving points, predicted static
  double static_error = 0;            //!< sum of end-point errors of the flow of static cells [m]
  double moving_error = 0;            //!< sum of end-point errors of the flow of moving cells [m]
  std::uint64_t static_cells = 0;
  std::uint64_t moving_cells = 0;
  double translation_error = 0;  //!< sum of the translation errors of the static motion [m]
  double yaw_error = 0;          //!< sum of the yaw errors of the static motion [rad]
  std::uint64_t pairs = 0;

  /** Ratios in [0, 1]; nothing where the denominator is 0. */
  [[nodiscard]] std::optional<double> iou() const;
  [[nodiscard]] std::optional<double> precision() const;
  [[nodiscard]] std::optional<double> recall() const;
  void add(const DysegScores& other);
};

/** Forward pass of one pair, evaluated on all labelled points of the scan. \param guess initial
 * ego-motion, current to past, as the application has for scans farther back; null for a search
 * over all motions in the correlation window. \param iterations flow updates, at least 1. */
[[nodiscard]] DysegScores scorePair(const DysegModel& model,
                                    const DysegSample& sample,
                                    const PlanarPrior* guess = nullptr,
                                    int iterations = 2);
}  // namespace dyslam
