// SPDX-License-Identifier: BSD-3-Clause
#include "TruePoses.h"

#include <cmath>
#include <cstddef>

namespace dyslam
{
namespace
{
constexpr double same_stamp = 1e-6;  //!< stamps this near are one [s]
constexpr double memory = 2.0;       //!< how long old poses are kept [s]
}  // namespace

void TruePoses::add(double stamp, const Pose& T_world_vehicle, double clock_shift)
{
  entries_.push_back({stamp, T_world_vehicle, clock_shift});
}

void TruePoses::shiftClock(double clock_shift, double shift)
{
  std::size_t begin = entries_.size();
  double farthest = 0;
  for (std::size_t i = 1; i < entries_.size(); ++i)
  {
    const double back = entries_[i - 1].stamp - entries_[i].stamp;
    if (entries_[i - 1].clock_shift == clock_shift && back > farthest)
    {
      begin = i;
      farthest = back;
    }
  }
  for (; begin < entries_.size(); ++begin)
  {
    entries_[begin].clock_shift += shift;
  }
}

std::optional<Pose> TruePoses::at(double stamp, double clock_shift)
{
  while (!entries_.empty() &&
         (entries_.front().clock_shift < clock_shift || entries_.front().stamp < stamp - memory))
  {
    entries_.pop_front();
  }
  const Entry* before = nullptr;
  const Entry* after = nullptr;
  for (const Entry& entry : entries_)
  {
    if (entry.clock_shift > clock_shift)
    {
      break;  // the clock was set back; its times may be like those before
    }
    if (std::abs(entry.stamp - stamp) <= same_stamp)
    {
      return entry.pose;
    }
    if (entry.stamp < stamp && (before == nullptr || entry.stamp > before->stamp))
    {
      before = &entry;
    }
    if (entry.stamp > stamp && (after == nullptr || entry.stamp < after->stamp))
    {
      after = &entry;
    }
  }
  if (before == nullptr || after == nullptr || stamp - before->stamp > max_gap_ ||
      after->stamp - stamp > max_gap_)
  {
    return std::nullopt;
  }
  const double fraction = (stamp - before->stamp) / (after->stamp - before->stamp);
  return interpolate(before->pose, after->pose, fraction);
}
}  // namespace dyslam
