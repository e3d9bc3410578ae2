// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/PathLength.h>
#include <dyslam/core/Trajectory.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace dyslam
{
namespace
{
/** Iterator to the first pose at or after a time. */
auto lowerBound(const std::vector<StampedPose>& poses, double stamp)
{
  return std::lower_bound(poses.begin(), poses.end(), stamp,
                          [](const StampedPose& p, double t) { return p.stamp < t; });
}
}  // namespace

void Trajectory::push_back(double stamp, const Pose& pose)
{
  poses_.push_back({stamp, pose});
}

std::optional<Pose> Trajectory::at(double stamp) const
{
  if (poses_.empty() || stamp < poses_.front().stamp || stamp > poses_.back().stamp)
  {
    return std::nullopt;
  }
  const auto after = lowerBound(poses_, stamp);
  if (after->stamp == stamp || after == poses_.begin())
  {
    return after->pose;
  }
  const auto before = std::prev(after);
  const double fraction = (stamp - before->stamp) / (after->stamp - before->stamp);
  return interpolate(before->pose, after->pose, fraction);
}

std::optional<std::size_t> Trajectory::nearest(double stamp, double tolerance) const
{
  auto it = lowerBound(poses_, stamp);
  if (it == poses_.end() ||
      (it != poses_.begin() && stamp - std::prev(it)->stamp < it->stamp - stamp))
  {
    if (it == poses_.begin())
    {
      return std::nullopt;
    }
    --it;
  }
  if (std::abs(it->stamp - stamp) > tolerance)
  {
    return std::nullopt;
  }
  return static_cast<std::size_t>(it - poses_.begin());
}

std::size_t Trajectory::firstNotBefore(double stamp) const
{
  return static_cast<std::size_t>(lowerBound(poses_, stamp) - poses_.begin());
}

std::optional<Pose> Trajectory::at(double stamp, double max_gap) const
{
  const auto after = lowerBound(poses_, stamp);
  if (after == poses_.end() || after->stamp - stamp > max_gap)
  {
    return std::nullopt;
  }
  const bool is_exact = after->stamp == stamp;
  if (!is_exact && (after == poses_.begin() || stamp - std::prev(after)->stamp > max_gap))
  {
    return std::nullopt;
  }
  return at(stamp);
}

std::vector<double> Trajectory::pathLengths() const
{
  PathLength path;
  std::vector<double> lengths;
  lengths.reserve(poses_.size());
  for (const StampedPose& pose : poses_)
  {
    lengths.push_back(path.add(pose.pose.translation()));
  }
  return lengths;
}

void Trajectory::exchangeState(StateArchive& archive)
{
  archive(poses_);
}
}  // namespace dyslam
