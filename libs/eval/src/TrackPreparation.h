// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Assignment.h>
#include <dyslam/eval/TrackMetrics.h>

#include <map>
#include <vector>

namespace dyslam::track_evaluation
{
/** One frame, prepared for matching at any threshold. */
struct EvaluationFrame
{
  std::vector<int> reference_id;
  std::vector<bool> ignored;  //!< per reference box: ignored, neither hit nor miss
  std::vector<int> estimate_id;
  std::vector<bool> ignorable;  //!< per estimate: no false positive if unmatched
  /** IoU, or similarity by distance (TrackRules::max_distance); references x estimates. */
  CostMatrix similarity;
};

struct Sequence
{
  std::vector<EvaluationFrame> frames;
  std::map<int, double> mean_score;  //!< mean score of each estimated track
};

/** Boxes selected by the rules, by frame, with their similarities. */
[[nodiscard]] std::vector<Sequence> prepare(const std::vector<TrackSequence>& sequences,
                                            const TrackRules& rules);

/** Whether the rules ignore this reference box (neither hit nor miss), regardless of its class. */
[[nodiscard]] bool isIgnored(const LabelledBox& box, const TrackRules& rules);

/** Case-insensitive comparison of class names. */
[[nodiscard]] bool sameType(const std::string& a, const std::string& b);
}  // namespace dyslam::track_evaluation
