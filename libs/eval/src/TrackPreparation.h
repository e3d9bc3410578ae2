// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Assignment.h>
#include <dyslam/eval/TrackMetrics.h>

#include <map>
#include <vector>

namespace dyslam::track_evaluation
{
/** One frame, ready to be matched at any threshold. */
struct EvaluationFrame
{
  std::vector<int> reference_id;
  std::vector<bool> passed_over;  //!< per reference box: a match is no hit, a miss no miss
  std::vector<int> estimate_id;
  std::vector<bool> excusable;  //!< per estimate: no false alarm when unmatched
  CostMatrix iou;               //!< references x estimates
};

struct Sequence
{
  std::vector<EvaluationFrame> frames;
  std::map<int, double> mean_score;  //!< of each estimated track
};

/** Boxes that the rules let in, by frame, with their overlaps. */
[[nodiscard]] std::vector<Sequence> prepare(const std::vector<TrackSequence>& sequences,
                                            const TrackRules& rules);

/** Whether the rules count neither a hit nor a miss of this reference box, whatever its class. */
[[nodiscard]] bool isPassedOver(const LabelledBox& box, const TrackRules& rules);

/** Whether two class names are the same but for case. */
[[nodiscard]] bool sameType(const std::string& a, const std::string& b);
}  // namespace dyslam::track_evaluation
