// SPDX-License-Identifier: BSD-3-Clause
#include "LoopAgreement.h"

#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double max_translation_error = 0.75;  // of a cycle of loops that agree [m]
constexpr double max_rotation_error = 0.06;     // of a cycle of loops that agree [rad]

bool agree(const Loop& a, const Loop& b, const KeyframeStore& keyframes)
{
  const Pose error = cycleError(a, b, keyframes);
  return error.translation().norm() < max_translation_error &&
         rotationAngle(error) < max_rotation_error;
}
}  // namespace

Pose poseBetween(const KeyframeStore& keyframes, std::size_t from, std::size_t to)
{
  return keyframes[from].T_map_vehicle.inverse() * keyframes[to].T_map_vehicle;
}

Pose cycleError(const Loop& a, const Loop& b, const KeyframeStore& keyframes)
{
  return a.T_from_to.inverse() * poseBetween(keyframes, a.from, b.from) * b.T_from_to *
         poseBetween(keyframes, b.to, a.to);
}

void LoopAgreement::add(const Loop& loop, const KeyframeStore& keyframes)
{
  Entry added{loop};
  const auto window = static_cast<std::size_t>(window_);
  for (Entry& other : entries_)
  {
    const std::size_t gap =
        std::max(other.loop.from, loop.from) - std::min(other.loop.from, loop.from);
    const bool nearby =
        gap <= window && loop.to - other.loop.to <= window && other.loop.to != loop.to;
    if (nearby && agree(loop, other.loop, keyframes))
    {
      // A loop by appearance does not support one within the search radius, but is supported by it.
      other.support += !loop.by_appearance || other.loop.by_appearance ? 1 : 0;
      added.support += !other.loop.by_appearance || loop.by_appearance ? 1 : 0;
    }
  }
  entries_.push_back(std::move(added));
}

std::vector<Loop> LoopAgreement::decide(std::size_t newest_keyframe)
{
  std::vector<Loop> decided;
  std::vector<Entry> left;
  for (Entry& entry : entries_)
  {
    const int needed = entry.loop.by_appearance ? appearance_support_ : min_support_;
    if (!entry.accepted && entry.support >= needed)
    {
      decided.push_back(entry.loop);
      entry.accepted = true;
    }
    if (newest_keyframe - entry.loop.to < static_cast<std::size_t>(window_))
    {
      left.push_back(entry);
    }
    else if (!entry.accepted)
    {
      entry.loop.verdict = LoopVerdict::unsupported;
      decided.push_back(entry.loop);
    }
  }
  entries_ = std::move(left);
  return decided;
}

std::vector<Loop> LoopAgreement::finish()
{
  std::vector<Loop> decided;
  for (Entry& entry : entries_)
  {
    if (!entry.accepted)
    {
      entry.loop.verdict = LoopVerdict::unsupported;
      decided.push_back(entry.loop);
    }
  }
  entries_.clear();
  return decided;
}

void LoopAgreement::exchangeState(StateArchive& archive)
{
  archive(entries_);
}
}  // namespace dyslam
