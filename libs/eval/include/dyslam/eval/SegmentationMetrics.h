// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Counts and scores of the moving class. */
struct SegmentationScores
{
  std::size_t true_positives = 0;
  std::size_t false_positives = 0;
  std::size_t false_negatives = 0;
  std::size_t true_negatives = 0;
  std::size_t ignored = 0;  //!< points whose reference label is 0 or 1 (unlabelled, outlier)

  SegmentationScores& operator+=(const SegmentationScores& other);

  /** Ratios in [0, 1]; nothing where the denominator is 0. */
  [[nodiscard]] std::optional<double> iou() const;
  [[nodiscard]] std::optional<double> precision() const;
  [[nodiscard]] std::optional<double> recall() const;
  [[nodiscard]] std::optional<double> staticIou() const;
  /** Fraction of the static points that were estimated as static, which a map keeps (SA of the KTH
   * dynamic-map benchmark, per point). The fraction of moving points removed (DA) is recall(). */
  [[nodiscard]] std::optional<double> staticKept() const;
  /** Fraction of the points that the reference labels as moving or static. */
  [[nodiscard]] std::optional<double> labelledShare() const;
};

/** Number of points of one reference class, and of those estimated as moving. */
struct ClassScores
{
  std::size_t points = 0;
  std::size_t called_moving = 0;
};

/** Moving-object segmentation over many scans, as SemanticKITTI-MOS defines it.
 *
 * The low 16 bits of a label are its class. Classes 252-259 (and 251, moving of unknown class) are
 * moving; 0 and 1 (unlabelled, outlier) are ignored in the reference; all others are static. An
 * estimated 0 counts as static.
 */
class SegmentationEvaluator
{
 public:
  /** Adds the labels of a scan. \throws std::invalid_argument if the arrays differ in length. */
  void add(const std::vector<std::uint32_t>& reference, const std::vector<std::uint32_t>& estimate);

  [[nodiscard]] const SegmentationScores& scores() const { return scores_; }
  /** Counts by reference class, without classes 0 and 1. */
  [[nodiscard]] const std::map<std::uint16_t, ClassScores>& perClass() const { return classes_; }
  [[nodiscard]] std::size_t scans() const { return scans_; }

 private:
  SegmentationScores scores_;
  std::map<std::uint16_t, ClassScores> classes_;
  std::size_t scans_ = 0;
};

/** Whether a class is 0 (unlabelled) or has a name. */
[[nodiscard]] bool isSemanticKittiClass(std::uint16_t semantic_class);

/** SemanticKITTI's name of a class; "class N" for unknown ones. */
[[nodiscard]] std::string semanticKittiName(std::uint16_t semantic_class);
}  // namespace dyslam
