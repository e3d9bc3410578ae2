// SPDX-License-Identifier: BSD-3-Clause
#include "HeldScans.h"

#include <algorithm>
#include <utility>

namespace dyslam
{
void HeldScans::hold(Entry entry)
{
  ++waiting_of_[entry.lidar];
  auto place = waiting_.end();
  for (auto other = waiting_.end(); look_ahead_ > 0 && other != waiting_.begin();)
  {
    --other;
    const double back = other->scan.stamp - entry.scan.stamp;
    if (other->lidar == entry.lidar)
    {
      if (!(back > 0 && back < longest_back))
      {
        break;
      }
      place = other;
    }
  }
  if (place != waiting_.end())
  {
    entry.progress = std::min(entry.progress, place->progress);  // does not go back
    ++sorted_;
  }
  waiting_.insert(place, std::move(entry));
}

bool HeldScans::passOn(double recorded)
{
  while (takes_more_ && !waiting_.empty() && !mustWait(waiting_.front(), recorded))
  {
    passOnFirst();
  }
  return takes_more_;
}

void HeldScans::passOnAll()
{
  while (takes_more_ && !waiting_.empty())
  {
    passOnFirst();
  }
  sink_.putRest();
}

bool HeldScans::mustWait(const Entry& entry, double recorded) const
{
  const bool are_few = std::all_of(waiting_of_.begin(), waiting_of_.end(),
                                   [](const auto& lidar) { return lidar.second <= most; });
  const bool may_be_late = waiting_of_.at(entry.lidar) <= look_ahead_;
  return are_few && recorded - entry.recorded < longest_wait &&
         (may_be_late || !motion_.hasSamplesFrom(entry.scan.stamp));
}

void HeldScans::passOnFirst()
{
  Entry entry = std::move(waiting_.front());
  waiting_.pop_front();
  --waiting_of_[entry.lidar];
  if (entry.lidar > 0)
  {
    sink_.putFurther(std::move(entry.scan));
    return;
  }
  const std::size_t written = sink_.written();
  takes_more_ = sink_.put(std::move(entry.scan), true, entry.T_world_lidar, entry.progress);
  without_pose_ += sink_.written() > written && !entry.T_world_lidar ? 1 : 0;
}
}  // namespace dyslam
