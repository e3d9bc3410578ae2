// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Statistics.h>
#include <dyslam/core/Labels.h>
#include <dyslam/eval/SegmentationMetrics.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::array<std::pair<std::uint16_t, const char*>, 35> class_names{
    {{1, "outlier"},
     {9, "static"},
     {10, "car"},
     {11, "bicycle"},
     {13, "bus"},
     {15, "motorcycle"},
     {16, "on-rails"},
     {18, "truck"},
     {20, "other-vehicle"},
     {30, "person"},
     {31, "bicyclist"},
     {32, "motorcyclist"},
     {40, "road"},
     {44, "parking"},
     {48, "sidewalk"},
     {49, "other-ground"},
     {50, "building"},
     {51, "fence"},
     {52, "other-structure"},
     {60, "lane-marking"},
     {70, "vegetation"},
     {71, "trunk"},
     {72, "terrain"},
     {80, "pole"},
     {81, "traffic-sign"},
     {99, "other-object"},
     {251, "moving"},
     {252, "moving-car"},
     {253, "moving-bicyclist"},
     {254, "moving-person"},
     {255, "moving-motorcyclist"},
     {256, "moving-on-rails"},
     {257, "moving-bus"},
     {258, "moving-truck"},
     {259, "moving-other-vehicle"}}};
}  // namespace

SegmentationScores& SegmentationScores::operator+=(const SegmentationScores& other)
{
  true_positives += other.true_positives;
  false_positives += other.false_positives;
  false_negatives += other.false_negatives;
  true_negatives += other.true_negatives;
  ignored += other.ignored;
  return *this;
}

std::optional<double> SegmentationScores::iou() const
{
  return ratio(true_positives, true_positives + false_positives + false_negatives);
}

std::optional<double> SegmentationScores::precision() const
{
  return ratio(true_positives, true_positives + false_positives);
}

std::optional<double> SegmentationScores::recall() const
{
  return ratio(true_positives, true_positives + false_negatives);
}

std::optional<double> SegmentationScores::labelledShare() const
{
  const std::size_t labelled = true_positives + false_positives + false_negatives + true_negatives;
  return ratio(labelled, labelled + ignored);
}

std::optional<double> SegmentationScores::staticIou() const
{
  return ratio(true_negatives, true_negatives + false_positives + false_negatives);
}

std::optional<double> SegmentationScores::staticKept() const
{
  return ratio(true_negatives, true_negatives + false_positives);
}

void SegmentationEvaluator::add(const std::vector<std::uint32_t>& reference,
                                const std::vector<std::uint32_t>& estimate)
{
  if (reference.size() != estimate.size())
  {
    throw std::invalid_argument("SegmentationEvaluator: " + std::to_string(reference.size()) +
                                " reference labels, " + std::to_string(estimate.size()) +
                                " estimated ones");
  }
  ++scans_;
  for (std::size_t i = 0; i < reference.size(); ++i)
  {
    if (isIgnoredLabel(reference[i]))
    {
      ++scores_.ignored;
      continue;
    }
    const bool moving = isMovingLabel(reference[i]);
    const bool called_moving = isMovingLabel(estimate[i]);
    auto& entry = classes_[static_cast<std::uint16_t>(reference[i] & 0xFFFFU)];
    ++entry.points;
    entry.called_moving += called_moving ? 1 : 0;
    auto& count = moving ? (called_moving ? scores_.true_positives : scores_.false_negatives)
                         : (called_moving ? scores_.false_positives : scores_.true_negatives);
    ++count;
  }
}

bool isSemanticKittiClass(std::uint16_t semantic_class)
{
  return semantic_class == 0 ||
         std::any_of(class_names.begin(), class_names.end(),
                     [&](const auto& named) { return named.first == semantic_class; });
}

std::string semanticKittiName(std::uint16_t semantic_class)
{
  for (const auto& [value, name] : class_names)
  {
    if (value == semantic_class)
    {
      return name;
    }
  }
  return "class " + std::to_string(semantic_class);
}
}  // namespace dyslam
