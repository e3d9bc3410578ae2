// SPDX-License-Identifier: BSD-3-Clause
#include "GivenLabels.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace dyslam
{
namespace
{
constexpr float probability = 0.999F;  // moving probability of a point labelled as moving

/** Folder of the labels; empty if none is given. \throws UserError if it has no labels */
std::string requireLabels(const std::string& folder)
{
  const auto labels = labelFolderOf(folder);
  if (!labels && !folder.empty())
  {
    throw UserError("dyseg.labels: " + folder +
                    ": has no labels; give the folder of a run with --labels, or of NNNNNN.label "
                    "files, one for each scan");
  }
  return labels.value_or("");
}

/** Whether the first label files have no moving class, but numbers below those of SemanticKITTI's
 * classes, as the learning map of moving object segmentation (1 static, 2 moving). */
bool areOfALearningMap(const std::string& folder)
{
  constexpr std::size_t most_files = 100;
  constexpr std::uint16_t first = 2;  // 0 and 1 are classes: unlabelled, outlier
  constexpr std::uint16_t last = 8;
  std::vector<std::string> files;
  for (const auto& entry : entriesOf(folder))
  {
    if (entry.path().extension() == ".label")
    {
      files.push_back(entry.path().string());
    }
  }
  files.resize(std::min(files.size(), most_files));
  bool has_such_numbers = false;
  for (const std::string& file : files)
  {
    for (const Label label : readLabels(file))
    {
      if (isMovingLabel(label))
      {
        return false;
      }
      has_such_numbers =
          has_such_numbers || (semanticOf(label) >= first && semanticOf(label) <= last);
    }
  }
  return has_such_numbers;
}

/** Merges per-point values of two clouds in the order of the scan. */
class Merge
{
 public:
  Merge(const std::vector<std::uint32_t>& kept, const std::vector<std::uint32_t>& added)
  {
    std::size_t k = 0;
    for (std::size_t a = 0; a < added.size() || k < kept.size();)
    {
      const bool from_kept = a == added.size() || (k < kept.size() && kept[k] < added[a]);
      from_kept_.push_back(from_kept);
      ++(from_kept ? k : a);
    }
    kept_ = kept.size();
    added_ = added.size();
  }
  /** Merges `added` into `kept`; does nothing if a cloud has no such values. */
  template <typename Values>
  void operator()(Values& kept, const Values& added) const
  {
    if (kept.size() != kept_ || added.size() != added_)
    {
      return;
    }
    Values both;
    both.reserve(from_kept_.size());
    std::size_t k = 0;
    std::size_t a = 0;
    for (const bool from_kept : from_kept_)
    {
      both.push_back(from_kept ? kept[k++] : added[a++]);
    }
    kept = std::move(both);
  }

 private:
  std::size_t kept_ = 0;
  std::size_t added_ = 0;
  std::vector<bool> from_kept_;
};
}  // namespace

GivenLabels::GivenLabels(const std::string& folder)
    : folder_(requireLabels(folder)),
      are_of_learning_map_(!folder_.empty() && areOfALearningMap(folder_))
{
}

std::vector<std::string> GivenLabels::warnings() const
{
  std::vector<std::string> result;
  if (are_of_learning_map_)
  {
    result.push_back("dyseg.labels: no label of " + folder_ +
                     " is of a moving class (251 to 259), so they have no effect; map the numbers "
                     "of a learning map to SemanticKITTI's classes (1 to 9, 2 to 251)");
  }
  return result;
}

LabelledPoints GivenLabels::pointsOf(const Frame& frame) const
{
  std::vector<bool> moving;
  if (!folder_.empty())
  {
    const std::vector<Label> labels =
        readLabels(numberedPath(folder_, frame.index, ".label"), frame.scan.size());
    moving.reserve(labels.size());
    for (const Label label : labels)
    {
      moving.push_back(isMovingLabel(label));
    }
  }
  return LabelledPoints(std::move(moving));
}

void LabelledPoints::takeFrom(Cloud& cloud)
{
  if (moving_.empty())
  {
    return;
  }
  cloud_ = Cloud();
  const Cloud all = std::exchange(cloud, {});
  for (Cloud* part : {&cloud, &cloud_})
  {
    part->T_sweep = all.T_sweep;
    part->phase_unit = all.phase_unit;
  }
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    Cloud& part = moving_[all.source[i]] ? cloud_ : cloud;
    part.points.push_back(all.points[i]);
    part.source.push_back(all.source[i]);
    if (!all.intensity.empty())
    {
      part.intensity.push_back(all.intensity[i]);
    }
    if (!all.phase.empty())
    {
      part.phase.push_back(all.phase[i]);
    }
  }
}

void LabelledPoints::takeFrom(Scan& scan)
{
  if (moving_.empty())
  {
    return;
  }
  scan_ = scan;
  for (std::size_t i = 0; i < moving_.size(); ++i)
  {
    (moving_[i] ? scan : scan_).points[i].setZero();
  }
}

void LabelledPoints::putBack(Frame& frame) const
{
  for (std::size_t i = 0; i < scan_.size(); ++i)
  {
    if (isReturn(scan_.points[i]))
    {
      frame.scan.points[i] = scan_.points[i];
    }
  }
  const std::size_t added = cloud_.size();
  const Merge merge(frame.cloud.source, cloud_.source);
  merge(frame.cloud.points, cloud_.points);
  merge(frame.cloud.intensity, cloud_.intensity);
  merge(frame.cloud.phase, cloud_.phase);
  merge(frame.moving_probability, std::vector<float>(added, probability));
  merge(frame.static_prior, std::vector<float>(added, 1 - probability));
  merge(frame.static_confidence, std::vector<float>(added, 1 - probability));
  merge(frame.cloud.source, cloud_.source);
}
}  // namespace dyslam
