// SPDX-License-Identifier: BSD-3-Clause
#include "MetScans.h"

#include <algorithm>
#include <cmath>

namespace dyslam
{
void MetScans::add(double stamp, bool is_used)
{
  scans_.push_back({stamp, is_used});
  if (scans_.size() > most)
  {
    scans_.pop_front();
  }
}

const MetScans::Met& MetScans::nearestTo(double stamp) const
{
  return *std::min_element(scans_.rbegin(), scans_.rend(),
                           [stamp](const Met& a, const Met& b)
                           { return std::abs(a.stamp - stamp) < std::abs(b.stamp - stamp); });
}

const MetScans::Met* MetScans::after(double stamp) const
{
  const auto found = std::find_if(scans_.begin(), scans_.end(),
                                  [stamp](const Met& met) { return met.stamp > stamp; });
  return found == scans_.end() ? nullptr : &*found;
}
}  // namespace dyslam
