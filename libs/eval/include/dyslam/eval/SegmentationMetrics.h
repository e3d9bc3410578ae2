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

  /** Each is nothing where it would be 0 / 0. */
  [[nodiscard]] std::optional<double> iou() const;
  [[nodiscard]] std::optional<double> precision() const;
  [[nodiscard]] std::optional<double> recall() const;
  [[nodiscard]] std::optional<double> staticIou() const;
};

/** What became of the points of one reference class. */
struct ClassScores
{
  std::size_t points = 0;
  std::size_t called_moving = 0;
};

/** Moving-object segmentation over many scans, as SemanticKITTI-MOS defines it.
 *
 * A label's low 16 bits are its class; 252-259 (and 251, where only moving is known) move,
 * 0 and 1 are unlabelled and outlier and ignored in the reference, everything else is static. An
 * estimated 0 counts as static.
 */
class SegmentationEvaluator
{
 public:
  /** \throws std::invalid_argument if the arrays differ in length. */
  void add(const std::vector<std::uint32_t>& reference, const std::vector<std::uint32_t>& estimate);

  [[nodiscard]] const SegmentationScores& scores() const { return scores_; }
  /** By the reference's class (0 and 1 left out). */
  [[nodiscard]] const std::map<std::uint16_t, ClassScores>& perClass() const { return classes_; }
  [[nodiscard]] std::size_t scans() const { return scans_; }

 private:
  SegmentationScores scores_;
  std::map<std::uint16_t, ClassScores> classes_;
  std::size_t scans_ = 0;
};

/** SemanticKITTI's name of a class; "class N" for others. */
[[nodiscard]] std::string semanticKittiName(std::uint16_t semantic_class);
}  // namespace dyslam
