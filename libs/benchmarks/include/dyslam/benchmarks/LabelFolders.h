// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Calibration.h>
#include <dyslam/eval/SegmentationMetrics.h>
#include <dyslam/eval/Table.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** The classes that occur in the labels of a side. */
struct LabelClasses
{
  std::size_t moving = 0;            //!< number of points of a moving class
  std::set<std::uint16_t> unlisted;  //!< classes that SemanticKITTI does not have
};

/** Segmentation scores over the scans common to two folders of `.label` files. */
struct LabelComparison
{
  SegmentationEvaluator evaluator;
  CalibrationEvaluator calibration;  //!< calibration of the probabilities, if the estimate has them
  std::size_t reference_scans = 0;
  std::size_t estimated_scans = 0;
  LabelClasses reference_classes;  //!< of the common scans, as in the files
  LabelClasses estimated_classes;  //!< of the common scans
};

/** Interpretation of the reference labels. */
struct ReferenceReading
{
  /** An instance that moves in one scan counts as moving in all scans, as in SemanticKITTI; else
   * only where its points are labelled moving. */
  bool ever_moving = false;
  std::set<std::uint16_t> standing;  //!< instances that count as static whatever their labels
};

/** Compares two folders of NNNNNN.label files, or folders with a subfolder `labels` of such files;
 * the folder `probabilities` beside the labels of the estimate is read, too. \throws UserError if
 * they are the same folder or have no scan in common, or the numbers of labels of a scan differ. */
[[nodiscard]] LabelComparison compareLabelFolders(const std::string& reference,
                                                  const std::string& estimate,
                                                  const ReferenceReading& reading = {});

/** Why the figures may be wrong, for the console: a side has no moving class, and classes that are
 * not SemanticKITTI's, such as those of a learning map. Empty if nothing is wrong.
 * \param reference, estimate their folders */
[[nodiscard]] std::string labelWarning(const std::string& reference,
                                       const std::string& estimate,
                                       const LabelComparison& result);

/** That labels are compared in a part of the scans only, for the console; empty if in all of both
 * sides. \param reference, estimate their folders */
[[nodiscard]] std::string partNote(const std::string& reference,
                                   const std::string& estimate,
                                   const LabelComparison& result);

using NamedComparisons = std::vector<std::pair<std::string, LabelComparison>>;
/** One row per estimate. */
[[nodiscard]] Table segmentationTable(const NamedComparisons& results);
/** Adds a row over all points of the estimates of several references, one for each method (see
 * methodGroups()). \param references folder of each estimate's reference \return why there is none;
 * empty if there is one */
std::string addTotalRows(Table& table,
                         const NamedComparisons& results,
                         const std::vector<std::string>& references);
/** Probabilities against the share of points that move, by ranges of probability. */
[[nodiscard]] Table calibrationTable(const CalibrationEvaluator& calibration);
/** Fraction of each reference class that was estimated as moving. */
[[nodiscard]] Table classTable(const LabelComparison& result);
[[nodiscard]] std::string segmentationJson(const NamedComparisons& results);
}  // namespace dyslam
