// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/Association.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace dyslam
{
namespace
{
PosePairs emptyPairs(const Trajectory& reference, const Trajectory& estimate)
{
  PosePairs pairs;
  pairs.reference_size = reference.size();
  pairs.estimate_size = estimate.size();
  return pairs;
}

void append(PosePairs& pairs, const StampedPose& reference, const StampedPose& estimate)
{
  pairs.stamps.push_back(reference.stamp);
  pairs.reference.push_back(reference.pose);
  pairs.estimate.push_back(estimate.pose);
}
}  // namespace

std::vector<double> distanceTravelled(const std::vector<Pose>& poses)
{
  std::vector<double> lengths(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i)
  {
    lengths[i] = lengths[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return lengths;
}

PosePairs associateByTime(const Trajectory& reference, const Trajectory& estimate, double tolerance)
{
  PosePairs pairs = emptyPairs(reference, estimate);
  std::map<std::size_t, std::size_t> estimate_of;
  const auto gap = [&](std::size_t r, std::size_t e)
  { return std::abs(reference[r].stamp - estimate[e].stamp); };
  for (std::size_t e = 0; e < estimate.size(); ++e)
  {
    if (!estimate[e].pose.matrix().allFinite())
    {
      ++pairs.not_finite;
      continue;
    }
    const auto r = reference.nearest(estimate[e].stamp, tolerance);
    if (!r || !reference[*r].pose.matrix().allFinite())
    {
      continue;
    }
    const auto [entry, is_new] = estimate_of.try_emplace(*r, e);
    if (!is_new && gap(*r, e) < gap(*r, entry->second))
    {
      entry->second = e;
    }
  }
  for (const auto& [r, e] : estimate_of)
  {
    append(pairs, reference[r], estimate[e]);
  }
  return pairs;
}

PosePairs associateInterpolated(const Trajectory& reference,
                                const Trajectory& estimate,
                                double max_gap)
{
  PosePairs pairs = emptyPairs(reference, estimate);
  for (const StampedPose& estimated : estimate)
  {
    if (!estimated.pose.matrix().allFinite())
    {
      ++pairs.not_finite;
      continue;
    }
    const auto pose = reference.at(estimated.stamp, max_gap);
    if (pose && pose->matrix().allFinite())
    {
      append(pairs, {estimated.stamp, *pose}, estimated);
    }
  }
  return pairs;
}

PosePairs associateByIndex(const Trajectory& reference, const Trajectory& estimate)
{
  PosePairs pairs = emptyPairs(reference, estimate);
  for (std::size_t i = 0; i < std::min(reference.size(), estimate.size()); ++i)
  {
    if (!estimate[i].pose.matrix().allFinite())
    {
      ++pairs.not_finite;
    }
    else if (reference[i].pose.matrix().allFinite())
    {
      append(pairs, reference[i], estimate[i]);
    }
  }
  return pairs;
}
}  // namespace dyslam
