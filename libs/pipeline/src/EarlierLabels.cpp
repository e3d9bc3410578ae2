// SPDX-License-Identifier: BSD-3-Clause
#include "EarlierLabels.h"

#include <dyslam/core/Error.h>
#include <dyslam/formats/LabelFiles.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "outputs/ScanLabels.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr float moving = 0.95F;  // probability of a point that was labelled so

std::string labelFolder(const std::string& folder)
{
  if (folder.empty())
  {
    return "";
  }
  const fs::path within = fs::path(folder) / "labels";
  const fs::path labels = fs::is_directory(within) ? within : fs::path(folder);
  const bool any =
      fs::is_directory(labels) &&
      std::any_of(fs::directory_iterator(labels), fs::directory_iterator(),
                  [](const auto& file) { return file.path().extension() == ".label"; });
  if (!any)
  {
    throw UserError(folder + ": has no labels (dyseg.labels); run dyslam --labels first");
  }
  return labels.string();
}

/** Where the points of two clouds are in the one of both, in the order of the scan. */
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
  }
  /** Leaves values as they are that the kept points do not have. */
  template <typename Values>
  void operator()(Values& kept, const Values& added) const
  {
    if (kept.size() != kept_)
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
  std::vector<bool> from_kept_;
};
}  // namespace

EarlierLabels::EarlierLabels(const std::string& folder) : folder_(labelFolder(folder)) {}

std::vector<Eigen::Vector3f> EarlierLabels::removeMoving(Frame& frame) const
{
  std::vector<Eigen::Vector3f>& points = frame.scan.points;
  const std::vector<Label> labels =
      readLabels(numberedPath(folder_, frame.index, ".label"), points.size());
  std::vector<Eigen::Vector3f> before = points;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (isMovingLabel(labels[i]))
    {
      points[i].setZero();
    }
  }
  return before;
}

void putBackMoving(const Cloud& cloud, std::vector<Eigen::Vector3f> points, Frame& frame)
{
  frame.scan.points = std::move(points);
  const std::size_t added = cloud.size();
  const std::size_t kept = frame.cloud.size();
  frame.moving.resize(kept, false);
  frame.moving_probability.resize(kept, 0);
  const Merge merge(frame.cloud.source, cloud.source);
  merge(frame.cloud.points, cloud.points);
  merge(frame.cloud.intensity, cloud.intensity);
  merge(frame.cloud.phase, cloud.phase);
  merge(frame.moving, std::vector<bool>(added, true));
  merge(frame.moving_probability, std::vector<float>(added, moving));
  merge(frame.static_prior, std::vector<float>(added, 1 - moving));
  merge(frame.static_confidence, std::vector<float>(added, 1 - moving));
  merge(frame.cloud.source, cloud.source);
}
}  // namespace dyslam
