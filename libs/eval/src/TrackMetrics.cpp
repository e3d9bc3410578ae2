// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Assignment.h>
#include <dyslam/eval/TrackMetrics.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "TrackPreparation.h"

namespace dyslam
{
using track_evaluation::EvaluationFrame;
using track_evaluation::prepare;
using track_evaluation::sameType;
using track_evaluation::Sequence;

namespace
{
/** Matched estimate (id or -1) and ignored flag of one reference track, per frame. */
struct TrackHistory
{
  std::vector<int> matched;
  std::vector<bool> ignored;
};

constexpr double all_tracks = -std::numeric_limits<double>::infinity();
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

class ClearMotCount
{
 public:
  ClearMotCount(const TrackRules& rules, double threshold) : rules_(rules)
  {
    result_.threshold = threshold;
  }

  void add(const Sequence& sequence)
  {
    std::map<int, TrackHistory> histories;
    for (const EvaluationFrame& frame : sequence.frames)
    {
      addFrame(frame, sequence.mean_score, histories);
    }
    for (const auto& [id, history] : histories)
    {
      addTrack(history);
    }
  }

  ClearMot result() const
  {
    ClearMot r = result_;
    const auto ratio = [](double a, double b) { return b > 0 ? a / b : undefined; };
    const auto tp = static_cast<double>(r.matches);
    const auto fp = static_cast<double>(r.false_alarms);
    const auto fn = static_cast<double>(r.misses);
    r.precision = ratio(tp, tp + fp);
    r.recall = ratio(tp, tp + fn);
    r.motp = ratio(overlap_, tp);
    r.mota =
        1 - ratio(fn + fp + static_cast<double>(r.id_switches), static_cast<double>(r.references));
    r.mostly_tracked = ratio(mostly_tracked_, reference_tracks_);
    r.mostly_lost = ratio(mostly_lost_, reference_tracks_);
    return r;
  }

  const std::vector<double>& matchScores() const { return match_scores_; }

 private:
  void addFrame(const EvaluationFrame& frame,
                const std::map<int, double>& mean_score,
                std::map<int, TrackHistory>& histories)
  {
    std::vector<Eigen::Index> kept;
    for (std::size_t j = 0; j < frame.estimate_id.size(); ++j)
    {
      if (mean_score.at(frame.estimate_id[j]) >= result_.threshold)
      {
        kept.push_back(static_cast<Eigen::Index>(j));
      }
    }
    CostMatrix cost(frame.similarity.rows(), static_cast<Eigen::Index>(kept.size()));
    for (Eigen::Index i = 0; i < cost.rows(); ++i)
    {
      for (Eigen::Index j = 0; j < cost.cols(); ++j)
      {
        const double similarity = frame.similarity(i, kept[static_cast<std::size_t>(j)]);
        cost(i, j) =
            similarity >= rules_.min_iou ? 1 - similarity : std::numeric_limits<double>::infinity();
      }
    }
    const Assignment assignment = assignShortestPaths(cost);
    for (std::size_t i = 0; i < frame.reference_id.size(); ++i)
    {
      const int j = assignment.column_of_row[i];
      TrackHistory& history = histories[frame.reference_id[i]];
      history.ignored.push_back(frame.ignored[i]);
      history.matched.push_back(-1);
      result_.references += frame.ignored[i] ? 0 : 1;
      if (j < 0)
      {
        result_.misses += frame.ignored[i] ? 0 : 1;
        continue;
      }
      const auto estimate = static_cast<std::size_t>(kept[static_cast<std::size_t>(j)]);
      history.matched.back() = frame.estimate_id[estimate];
      if (frame.ignored[i] && !rules_.image_rules)
      {
        continue;  // only KITTI counts ignored boxes
      }
      overlap_ += 1 - cost(static_cast<Eigen::Index>(i), j);
      ++result_.matches;
      match_scores_.push_back(mean_score.at(frame.estimate_id[estimate]));
    }
    for (std::size_t j = 0; j < kept.size(); ++j)
    {
      if (assignment.row_of_column[j] < 0 && !frame.ignorable[static_cast<std::size_t>(kept[j])])
      {
        ++result_.false_alarms;
      }
    }
  }

  void addTrack(const TrackHistory& history)
  {
    const std::size_t length = history.matched.size();
    std::size_t counted = 0;
    std::size_t tracked = 0;
    int last = -1;  // last matched id; reset by ignored boxes
    for (std::size_t f = 0; f < length; ++f)
    {
      if (history.ignored[f])
      {
        last = -1;
        continue;
      }
      ++counted;
      const int now = history.matched[f];
      const int before = f > 0 ? history.matched[f - 1] : -1;
      const int after = f + 1 < length ? history.matched[f + 1] : now;
      if (now >= 0 && last >= 0)
      {
        const bool seen_before = before >= 0 || rules_.switches_across_gaps;
        result_.id_switches += now != last && seen_before ? 1 : 0;
        result_.fragmentations += before != now && after >= 0 ? 1 : 0;
      }
      if (now >= 0)
      {
        ++tracked;
        last = now;
      }
    }
    if (counted == 0)
    {
      return;
    }
    reference_tracks_ += 1;
    const double tracked_ratio = static_cast<double>(tracked) / static_cast<double>(counted);
    mostly_tracked_ += tracked_ratio > 0.8 ? 1 : 0;
    mostly_lost_ += tracked_ratio < 0.2 ? 1 : 0;
  }

  const TrackRules& rules_;
  ClearMot result_;
  double overlap_ = 0;
  double reference_tracks_ = 0;
  double mostly_tracked_ = 0;
  double mostly_lost_ = 0;
  std::vector<double> match_scores_;
};

ClearMotCount count(const std::vector<Sequence>& sequences,
                    const TrackRules& rules,
                    double threshold)
{
  ClearMotCount counted(rules, threshold);
  for (const Sequence& sequence : sequences)
  {
    counted.add(sequence);
  }
  return counted;
}

/** (score threshold, recall) pairs nearest to the recalls 1/n, 2/n, ... */
std::vector<std::pair<double, double>> recallThresholds(std::vector<double> scores,
                                                        std::size_t references,
                                                        int points)
{
  std::sort(scores.begin(), scores.end(), std::greater<>());
  std::vector<std::pair<double, double>> result;
  const auto total = static_cast<double>(references);
  double target = 0;
  for (std::size_t i = 0; i < scores.size(); ++i)
  {
    const bool last = i + 1 == scores.size();
    const double here = static_cast<double>(i + 1) / total;
    const double next = last ? here : static_cast<double>(i + 2) / total;
    if (!last && next - target < target - here)
    {
      continue;  // the next score is nearer
    }
    result.emplace_back(scores[i], target);
    target += 1.0 / points;
  }
  if (!result.empty())
  {
    result.erase(result.begin());  // recall 0
  }
  return result;
}
}  // namespace

TrackRules TrackRules::kitti(const std::string& type)
{
  TrackRules rules;
  rules.type = type;
  if (sameType(type, "Car"))
  {
    rules.neighbours = {"Van"};
  }
  if (sameType(type, "Pedestrian"))
  {
    rules.neighbours = {"Person_sitting"};
  }
  return rules;
}

ClearMot clearMot(const std::vector<TrackSequence>& sequences, const TrackRules& rules)
{
  return clearMot(sequences, rules, all_tracks);
}

ClearMot clearMot(const std::vector<TrackSequence>& sequences,
                  const TrackRules& rules,
                  double threshold)
{
  return count(prepare(sequences, rules), rules, threshold).result();
}

std::vector<TrackSequence> tracksAbove(std::vector<TrackSequence> sequences, double threshold)
{
  for (TrackSequence& sequence : sequences)
  {
    std::map<int, std::pair<double, int>> sums;
    for (const LabelledBox& box : sequence.estimate)
    {
      sums[box.id].first += box.score;
      sums[box.id].second += 1;
    }
    const auto below = [&](const LabelledBox& box)
    {
      const auto& [sum, count] = sums.at(box.id);
      return !(sum / count >= threshold);
    };
    sequence.estimate.erase(
        std::remove_if(sequence.estimate.begin(), sequence.estimate.end(), below),
        sequence.estimate.end());
  }
  return sequences;
}

RecallAverages averagesOverRecall(const std::vector<TrackSequence>& sequences,
                                  const TrackRules& rules,
                                  int recall_points)
{
  const std::vector<Sequence> prepared = prepare(sequences, rules);
  const ClearMotCount all = count(prepared, rules, all_tracks);
  const ClearMot whole = all.result();
  RecallAverages averages;
  averages.best = whole;
  for (const auto& [threshold, recall] :
       recallThresholds(all.matchScores(), whole.matches + whole.misses, recall_points))
  {
    RecallAverages::Point point;
    point.recall = recall;
    point.mot = count(prepared, rules, threshold).result();
    // MOTA = 1 - errors / n; (1 - r) n of the misses are due to the target recall r.
    const double smota = 1 - (1 - point.mot.mota - (1 - recall)) / recall;
    point.smota = std::clamp(smota, 0.0, 1.0);
    averages.samota += point.smota / recall_points;
    averages.amota += point.mot.mota / recall_points;
    averages.amotp += point.mot.matches > 0 ? point.mot.motp / recall_points : 0;
    if (point.mot.mota > averages.best.mota)
    {
      averages.best = point.mot;
    }
    averages.points.push_back(point);
  }
  if (whole.references < static_cast<std::size_t>(recall_points))
  {
    averages.samota = averages.amota = averages.amotp = undefined;
  }
  return averages;
}
}  // namespace dyslam
