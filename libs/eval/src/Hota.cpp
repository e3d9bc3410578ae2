// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Assignment.h>
#include <dyslam/eval/TrackMetrics.h>

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "TrackPreparation.h"

namespace dyslam
{
namespace
{
using track_evaluation::EvaluationFrame;
using track_evaluation::Sequence;
using Ids = std::pair<int, int>;

constexpr double not_allowed = std::numeric_limits<double>::infinity();

/** The frame without ignored boxes: without ignored references, estimates matched to them, and
 * ignorable unmatched estimates. */
EvaluationFrame withoutIgnored(const EvaluationFrame& frame, double min_similarity)
{
  CostMatrix cost = frame.similarity;
  for (Eigen::Index i = 0; i < cost.size(); ++i)
  {
    double& c = cost.data()[i];
    c = c >= min_similarity ? 1 - c : not_allowed;
  }
  const Assignment matched = assignShortestPaths(cost);
  std::vector<Eigen::Index> rows;
  std::vector<Eigen::Index> columns;
  EvaluationFrame kept;
  for (std::size_t i = 0; i < frame.reference_id.size(); ++i)
  {
    if (!frame.ignored[i])
    {
      rows.push_back(static_cast<Eigen::Index>(i));
      kept.reference_id.push_back(frame.reference_id[i]);
    }
  }
  for (std::size_t j = 0; j < frame.estimate_id.size(); ++j)
  {
    const int row = matched.row_of_column[j];
    const bool ignored =
        row >= 0 ? frame.ignored[static_cast<std::size_t>(row)] : frame.ignorable[j];
    if (!ignored)
    {
      columns.push_back(static_cast<Eigen::Index>(j));
      kept.estimate_id.push_back(frame.estimate_id[j]);
    }
  }
  kept.similarity.resize(static_cast<Eigen::Index>(rows.size()),
                         static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    for (std::size_t j = 0; j < columns.size(); ++j)
    {
      kept.similarity(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          frame.similarity(rows[i], columns[j]);
    }
  }
  return kept;
}

/** Sums over all sequences at one IoU threshold. */
struct HotaSums
{
  double true_positives = 0;
  double misses = 0;
  double false_alarms = 0;
  double overlap = 0;
  double association = 0;  //!< sum over true positives of their pair's Jaccard index
};

class HotaSequence
{
 public:
  HotaSequence(const Sequence& sequence, const TrackRules& rules)
  {
    // KITTI matches ignored boxes from an IoU of 0.5 on, other rules by their own limit.
    const double least = rules.image_rules ? 0.5 : rules.min_iou;
    for (const EvaluationFrame& frame : sequence.frames)
    {
      frames_.push_back(withoutIgnored(frame, least));
    }
    for (const EvaluationFrame& frame : frames_)
    {
      accumulateAlignment(frame);
    }
  }

  void add(double alpha, HotaSums& sums) const
  {
    std::map<Ids, double> pairs;
    for (const EvaluationFrame& frame : frames_)
    {
      const Assignment matched = assignShortestPaths(matchingCost(frame), 0.0);
      double hits = 0;
      for (std::size_t i = 0; i < frame.reference_id.size(); ++i)
      {
        const int j = matched.column_of_row[i];
        if (j >= 0 && frame.similarity(static_cast<Eigen::Index>(i), j) >= alpha - 1e-9)
        {
          hits += 1;
          sums.overlap += frame.similarity(static_cast<Eigen::Index>(i), j);
          pairs[{frame.reference_id[i], frame.estimate_id[static_cast<std::size_t>(j)]}] += 1;
        }
      }
      sums.true_positives += hits;
      sums.misses += static_cast<double>(frame.reference_id.size()) - hits;
      sums.false_alarms += static_cast<double>(frame.estimate_id.size()) - hits;
    }
    for (const auto& [ids, count] : pairs)
    {
      sums.association +=
          count * count / (reference_count_.at(ids.first) + estimate_count_.at(ids.second) - count);
    }
  }

 private:
  /** Accumulates the global alignment score of each pair of ids (HOTA's potential matches). */
  void accumulateAlignment(const EvaluationFrame& frame)
  {
    for (const int id : frame.reference_id)
    {
      reference_count_[id] += 1;
    }
    for (const int id : frame.estimate_id)
    {
      estimate_count_[id] += 1;
    }
    if (frame.similarity.size() == 0)
    {
      return;
    }
    const Eigen::VectorXd rows = frame.similarity.rowwise().sum();
    const Eigen::RowVectorXd columns = frame.similarity.colwise().sum();
    for (Eigen::Index i = 0; i < frame.similarity.rows(); ++i)
    {
      for (Eigen::Index j = 0; j < frame.similarity.cols(); ++j)
      {
        if (frame.similarity(i, j) > 0)
        {
          alignment_score_[{frame.reference_id[static_cast<std::size_t>(i)],
                            frame.estimate_id[static_cast<std::size_t>(j)]}] +=
              frame.similarity(i, j) / (rows[i] + columns[j] - frame.similarity(i, j));
        }
      }
    }
  }

  CostMatrix matchingCost(const EvaluationFrame& frame) const
  {
    CostMatrix cost =
        CostMatrix::Constant(frame.similarity.rows(), frame.similarity.cols(), not_allowed);
    for (Eigen::Index i = 0; i < cost.rows(); ++i)
    {
      for (Eigen::Index j = 0; j < cost.cols(); ++j)
      {
        if (frame.similarity(i, j) > 0)
        {
          const Ids ids{frame.reference_id[static_cast<std::size_t>(i)],
                        frame.estimate_id[static_cast<std::size_t>(j)]};
          const double alignment = alignment_score_.at(ids);
          const double jaccard = alignment / (reference_count_.at(ids.first) +
                                              estimate_count_.at(ids.second) - alignment);
          cost(i, j) = -jaccard * frame.similarity(i, j);
        }
      }
    }
    return cost;
  }

  std::vector<EvaluationFrame> frames_;
  std::map<int, double> reference_count_;
  std::map<int, double> estimate_count_;
  std::map<Ids, double> alignment_score_;
};
}  // namespace

Hota hota(const std::vector<TrackSequence>& sequences, const TrackRules& rules)
{
  std::vector<HotaSequence> prepared;
  for (const Sequence& sequence : track_evaluation::prepare(sequences, rules))
  {
    prepared.emplace_back(sequence, rules);
  }
  constexpr int alphas = 19;
  const auto ratio = [](double a, double b) { return b > 0 ? a / b : 0.0; };
  Hota mean;
  for (int k = 1; k <= alphas; ++k)
  {
    HotaSums sums;
    for (const HotaSequence& sequence : prepared)
    {
      sequence.add(0.05 * k, sums);
    }
    const double detection =
        ratio(sums.true_positives, sums.true_positives + sums.misses + sums.false_alarms);
    const double association = ratio(sums.association, sums.true_positives);
    mean.detection += detection / alphas;
    mean.association += association / alphas;
    mean.hota += std::sqrt(detection * association) / alphas;
    // Without true positives the localisation accuracy is 1 by convention.
    mean.localization +=
        (sums.true_positives > 0 ? sums.overlap / sums.true_positives : 1.0) / alphas;
  }
  return mean;
}
}  // namespace dyslam
