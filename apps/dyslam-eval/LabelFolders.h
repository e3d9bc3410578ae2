// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/SegmentationMetrics.h>
#include <dyslam/eval/Table.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Segmentation scores over the scans common to two folders of `.label` files. */
struct LabelComparison
{
  SegmentationEvaluator evaluator;
  std::size_t reference_scans = 0;
  std::size_t estimated_scans = 0;
};

/** Folders of NNNNNN.label, or folders with such a subfolder `labels`.
 * \throws UserError if they have no scan in common or a scan's labels differ in number. */
[[nodiscard]] LabelComparison compareLabelFolders(const std::string& reference,
                                                  const std::string& estimate);

using NamedComparisons = std::vector<std::pair<std::string, LabelComparison>>;
[[nodiscard]] Table segmentationTable(const NamedComparisons& results);
/** Fraction of each reference class that was estimated as moving. */
[[nodiscard]] Table classTable(const LabelComparison& result);
[[nodiscard]] std::string segmentationJson(const NamedComparisons& results);
}  // namespace dyslam
