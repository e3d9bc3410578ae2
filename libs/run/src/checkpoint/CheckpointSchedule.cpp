// SPDX-License-Identifier: BSD-3-Clause
#include "CheckpointSchedule.h"

#include <algorithm>
#include <utility>

namespace dyslam
{
bool CheckpointSchedule::due(bool at_once)
{
  constexpr double share = 0.05;  // largest share of the run time for checkpoints
  const auto now = std::chrono::steady_clock::now();
  const double least = at_once ? 0 : std::max(seconds_, cost_ / share);
  if (seconds_ <= 0 || std::chrono::duration<double>(now - last_).count() < least)
  {
    return false;
  }
  last_ = now;
  return true;
}

void CheckpointSchedule::begin(std::size_t frame, BegunCheckpoint begun)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  begun_[frame] = std::move(begun);
}

std::optional<BegunCheckpoint> CheckpointSchedule::take(std::size_t frame)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = begun_.find(frame);
  if (found == begun_.end())
  {
    return std::nullopt;
  }
  BegunCheckpoint begun = std::move(found->second);
  begun_.erase(found);
  return begun;
}
}  // namespace dyslam
