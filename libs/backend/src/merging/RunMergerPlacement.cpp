// SPDX-License-Identifier: BSD-3-Clause
// Placements of runs in a merge: by loops, or by a frame in common.
#include <dyslam/backend/factors/LocalisationFactor.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "RunMergerState.h"

namespace dyslam
{
std::vector<Loop> RunMerger::State::largestGroup(const std::vector<Loop>& all) const
{
  std::vector<Loop> largest;
  for (const Loop& seed : all)
  {
    std::vector<Loop> group{seed};
    for (const Loop& other : all)
    {
      if (other.to != seed.to && finder.agree(seed, other))
      {
        group.push_back(other);
      }
    }
    if (group.size() > largest.size())
    {
      largest = std::move(group);
    }
  }
  return largest;
}

RunMerger::State::Placement RunMerger::State::bestPlacement() const
{
  Placement best;
  const auto least = static_cast<std::size_t>(config.loops.by_appearance.min_support);
  for (const Seeds& pair : seeds)
  {
    if (runs[pair.run_a].joined == runs[pair.run_b].joined)
    {
      continue;
    }
    std::vector<Loop> group = largestGroup(pair.loops);
    if (group.size() > std::max(best.loops.size(), least))
    {
      best.run = runs[pair.run_a].joined ? pair.run_b : pair.run_a;
      best.loops = std::move(group);
    }
  }
  return best;
}

void RunMerger::State::refuse(const Placement& placement)
{
  if (placement.T_map_run)
  {
    runs[placement.run].map_frame.clear();
    runs[placement.run].evidence = {};
    return;
  }
  const auto isRefused = [&](const Loop& loop)
  {
    return std::any_of(placement.loops.begin(), placement.loops.end(),
                       [&](const Loop& other)
                       { return other.from == loop.from && other.to == loop.to; });
  };
  for (Seeds& pair : seeds)
  {
    pair.loops.erase(std::remove_if(pair.loops.begin(), pair.loops.end(), isRefused),
                     pair.loops.end());
  }
}

void RunMerger::State::place(const Placement& placement)
{
  const KeyframeRange& range = runs[placement.run].range;
  Pose T_map_run = placement.T_map_run.value_or(Pose::Identity());
  if (!placement.T_map_run)
  {
    const Loop& seed = placement.loops.front();
    const Pose T_map_to = keyframes[seed.from].T_map_vehicle * seed.T_from_to;
    T_map_run = range.contains(seed.to)
                    ? T_map_to * keyframes[seed.to].T_map_vehicle.inverse()
                    : keyframes[seed.to].T_map_vehicle * seed.T_from_to.inverse() *
                          keyframes[seed.from].T_map_vehicle.inverse();
  }
  std::vector<Pose> poses = keyframes.poses();
  for (std::size_t k = range.begin; k < range.end; ++k)
  {
    poses[k] = orthonormalised(T_map_run * poses[k]);
  }
  keyframes.correct(poses);
}

Pose RunMerger::State::frameOf(const Run& run) const
{
  // The merged map is in the frame of the first run.
  return run.frame == 0
             ? Pose::Identity()
             : orthonormalised(keyframes[run.middle()].T_map_vehicle * run.T_own_middle.inverse());
}

std::optional<RunMerger::State::Placement> RunMerger::State::placementByFrame() const
{
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    for (const Run& other : runs)
    {
      if (!runs[r].joined && other.joined && !runs[r].map_frame.empty() &&
          runs[r].map_frame == other.map_frame)
      {
        Placement placement;
        placement.run = r;
        placement.T_map_run = frameOf(other);
        placement.frame = other.frame;
        return placement;
      }
    }
  }
  return std::nullopt;
}

void RunMerger::State::addLocalisations(FactorGraph& graph) const
{
  for (const Run& run : runs)
  {
    if (!run.joined || run.localisations.empty())
    {
      continue;
    }
    const Key prior_map = Key::priorMap(run.frame);
    if (!graph.contains(prior_map))
    {
      graph.addPose(prior_map, frameOf(run));
      graph.setFixed(prior_map, run.frame == 0);
    }
    for (const Localisation& fix : run.localisations)
    {
      graph.add(std::make_unique<LocalisationFactor>(fix.keyframe, fix.T_prior_vehicle,
                                                     fix.information, prior_map));
    }
  }
}

bool RunMerger::State::isConfirmed(const Placement& placement, std::size_t added) const
{
  const JoinEvidence& evidence = runs[placement.run].evidence;
  const bool along_the_path = static_cast<double>(evidence.confirmed) >=
                              config.merge.min_confirmed * static_cast<double>(evidence.tried);
  const auto least = static_cast<std::size_t>(config.loops.by_appearance.min_support);
  // A common frame needs no common place.
  return along_the_path &&
         (placement.T_map_run ? 2 * evidence.consistent >= added : evidence.consistent > least);
}
}  // namespace dyslam
