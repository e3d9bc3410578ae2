// SPDX-License-Identifier: BSD-3-Clause
#include "TrackPreparation.h"

#include <dyslam/base/Printable.h>
#include <dyslam/core/BoxOverlap.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace dyslam::track_evaluation
{
namespace
{
// KITTI's rules.
constexpr int max_truncated = 0;
constexpr int max_occluded = 2;
constexpr double min_image_height = 25;  // least image height of estimates [px]
constexpr double max_dontcare = 0.5;     // fraction of an estimate's image box in a DontCare area

double imageArea(const Eigen::Vector4d& box)
{
  return std::max(0.0, box[2] - box[0]) * std::max(0.0, box[3] - box[1]);
}

/** Fraction of image box a within b. */
double imageOverlap(const Eigen::Vector4d& a, const Eigen::Vector4d& b)
{
  const double width = std::min(a[2], b[2]) - std::max(a[0], b[0]);
  const double height = std::min(a[3], b[3]) - std::max(a[1], b[1]);
  const double area = imageArea(a);
  return width > 0 && height > 0 && area > 0 ? width * height / area : 0;
}

class Preparation
{
 public:
  Preparation(const TrackSequence& input, const TrackRules& rules) : input_(input), rules_(rules)
  {
    const auto count = static_cast<std::size_t>(std::max(0, input.frames));
    references_.resize(count);
    areas_.resize(count);
    estimates_.resize(count);
  }

  Sequence run()
  {
    distribute();
    Sequence sequence;
    std::map<int, std::pair<double, int>> sums;
    for (std::size_t f = 0; f < references_.size(); ++f)
    {
      sequence.frames.push_back(frame(f));
      for (const LabelledBox* box : estimates_[f])
      {
        sums[box->id].first += box->score;
        sums[box->id].second += 1;
      }
    }
    for (const auto& [id, sum] : sums)
    {
      sequence.mean_score[id] = sum.first / sum.second;
    }
    return sequence;
  }

 private:
  using Boxes = std::vector<const LabelledBox*>;

  bool inSequence(const LabelledBox& box) const
  {
    return box.frame >= 0 && box.frame < input_.frames;
  }
  bool isOfType(const LabelledBox& box) const
  {
    return rules_.type.empty() || sameType(box.type, rules_.type);
  }
  bool isOfNeighbourType(const LabelledBox& box) const
  {
    return std::any_of(rules_.neighbours.begin(), rules_.neighbours.end(),
                       [&](const std::string& type) { return sameType(type, box.type); });
  }

  void distribute()
  {
    for (const LabelledBox& box : input_.reference)
    {
      if (!inSequence(box))
      {
        continue;
      }
      const auto f = static_cast<std::size_t>(box.frame);
      if (sameType(box.type, "DontCare"))
      {
        areas_[f].push_back(&box);
      }
      else if (box.id >= 0 && (isOfType(box) || isOfNeighbourType(box)))
      {
        references_[f].push_back(&box);
      }
    }
    for (const LabelledBox& box : input_.estimate)
    {
      if (inSequence(box) && isOfType(box) && !sameType(box.type, "DontCare"))
      {
        estimates_[static_cast<std::size_t>(box.frame)].push_back(&box);
      }
    }
  }

  double similarity(const Box& reference, const Box& estimate) const
  {
    if (rules_.max_distance <= 0)
    {
      return boxIou(reference, estimate);
    }
    const double separation = (reference.centre - estimate.centre).head<2>().norm();
    return std::max(0.0, 1 - separation / rules_.max_distance);
  }

  EvaluationFrame frame(std::size_t f) const
  {
    EvaluationFrame result;
    for (const LabelledBox* box : references_[f])
    {
      result.reference_id.push_back(box->id);
      result.ignored.push_back(isIgnored(*box, rules_) || !isOfType(*box));
    }
    for (const LabelledBox* box : estimates_[f])
    {
      result.estimate_id.push_back(box->id);
      bool ignorable = false;
      if (rules_.image_rules)
      {
        ignorable = std::abs(box->image_box[3] - box->image_box[1]) <= min_image_height;
        for (const LabelledBox* area : areas_[f])
        {
          ignorable = ignorable || imageOverlap(box->image_box, area->image_box) > max_dontcare;
        }
      }
      result.ignorable.push_back(ignorable);
    }
    result.similarity.resize(static_cast<Eigen::Index>(references_[f].size()),
                             static_cast<Eigen::Index>(estimates_[f].size()));
    for (std::size_t i = 0; i < references_[f].size(); ++i)
    {
      for (std::size_t j = 0; j < estimates_[f].size(); ++j)
      {
        result.similarity(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            similarity(references_[f][i]->box, estimates_[f][j]->box);
      }
    }
    return result;
  }

  const TrackSequence& input_;
  const TrackRules& rules_;
  std::vector<Boxes> references_;
  std::vector<Boxes> areas_;
  std::vector<Boxes> estimates_;
};

}  // namespace

bool isIgnored(const LabelledBox& box, const TrackRules& rules)
{
  return box.occluded == ignored_box ||
         (rules.image_rules && (box.occluded > max_occluded || box.truncated > max_truncated));
}

bool sameType(const std::string& a, const std::string& b)
{
  return lowered(a) == lowered(b);
}

std::vector<Sequence> prepare(const std::vector<TrackSequence>& sequences, const TrackRules& rules)
{
  std::vector<Sequence> prepared;
  for (const TrackSequence& sequence : sequences)
  {
    prepared.push_back(Preparation(sequence, rules).run());
  }
  return prepared;
}
}  // namespace dyslam::track_evaluation
