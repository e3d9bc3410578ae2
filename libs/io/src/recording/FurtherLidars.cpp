// SPDX-License-Identifier: BSD-3-Clause
#include "FurtherLidars.h"

#include <dyslam/base/Error.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace dyslam
{
FurtherLidars::FurtherLidars(const std::string& labels, bool merge, double intensity_scale)
    : labels_("further_lidars", labels),
      merge_(merge && !labels.empty()),
      intensity_scale_(intensity_scale)
{
}

bool FurtherLidars::areNamed(const std::string& label) const
{
  return !labels_.pattern().empty() && labels_.fits(label);
}

void FurtherLidars::holdTimeRing(const std::string& label,
                                 const mrpt::obs::CObservation::Ptr& observation)
{
  if (merge_ && areNamed(label) && (time_rings_.size() < most_lidars || time_rings_.count(label)))
  {
    time_rings_[label] = observation;
  }
}

mrpt::obs::CObservation::Ptr FurtherLidars::takeTimeRing(const std::string& label)
{
  const auto found = time_rings_.find(label);
  if (found == time_rings_.end())
  {
    return nullptr;
  }
  mrpt::obs::CObservation::Ptr time_ring = std::move(found->second);
  time_rings_.erase(found);
  return time_ring;
}

void FurtherLidars::hold(HeldScan scan)
{
  const std::string& label = scan.observation->sensorLabel;
  scan.lidar = numbers_.emplace(label, numbers_.size() + 1).first->second;
  if (scan.lidar >= most_lidars)
  {
    throw UserError("further_lidars = " + labels_.pattern() + " selects more than " +
                    std::to_string(most_lidars - 1) + " lidars, '" + label +
                    "' too; name those of the vehicle");
  }
  latest_[scan.lidar] = scan.stamp;
  dropWaitingTooLong(scan);
  held_.push_back(std::move(scan));
}

bool FurtherLidars::isAwaited(const HeldScan& scan) const
{
  if (first_.empty())
  {
    return false;
  }
  const MetScans::Met& nearest = first_.nearestTo(scan.stamp);
  return nearest.is_used && (!last_ || nearest.stamp > *last_) &&
         std::abs(scan.stamp - nearest.stamp) <= farthest;
}

void FurtherLidars::dropWaitingTooLong(const HeldScan& newest)
{
  const std::size_t before = held_.size();
  held_.erase(std::remove_if(held_.begin(), held_.end(),
                             [&](const HeldScan& scan)
                             {
                               return scan.lidar == newest.lidar &&
                                      std::abs(scan.stamp - newest.stamp) > longest_wait &&
                                      !isAwaited(scan);
                             }),
              held_.end());
  const auto isSame = [&newest](const HeldScan& scan) { return scan.lidar == newest.lidar; };
  if (std::count_if(held_.begin(), held_.end(), isSame) >= static_cast<std::ptrdiff_t>(most_held))
  {
    held_.erase(std::find_if(held_.begin(), held_.end(), isSame));
  }
  dropped_ += before - held_.size();
}

void FurtherLidars::metScan(double stamp, bool taken)
{
  first_.add(stamp, taken);
  held_.erase(std::remove_if(held_.begin(), held_.end(),
                             [&](const HeldScan& scan) {
                               return scan.stamp <= stamp && !first_.nearestTo(scan.stamp).is_used;
                             }),
              held_.end());
}

bool FurtherLidars::areCompleteFor(double stamp) const
{
  const MetScans::Met* next = first_.after(stamp);
  return next != nullptr && std::all_of(latest_.begin(), latest_.end(),
                                        [&](const auto& lidar)
                                        { return lidar.second >= 0.5 * (stamp + next->stamp); });
}

std::vector<FurtherLidars::HeldScan> FurtherLidars::takeFor(double stamp)
{
  std::vector<HeldScan> taken;
  std::deque<HeldScan> left;
  for (HeldScan& scan : held_)
  {
    const MetScans::Met& nearest = first_.nearestTo(scan.stamp);
    if (nearest.stamp > stamp)
    {
      left.push_back(std::move(scan));
    }
    else if (nearest.is_used && std::abs(scan.stamp - stamp) <= farthest)
    {
      taken.push_back(std::move(scan));
    }
    else if (nearest.is_used)
    {
      ++dropped_;
    }
  }
  held_ = std::move(left);
  last_ = stamp;
  std::stable_sort(taken.begin(), taken.end(),
                   [](const HeldScan& a, const HeldScan& b)
                   { return std::tie(a.lidar, a.stamp) < std::tie(b.lidar, b.stamp); });
  any_taken_ = any_taken_ || !taken.empty();
  return taken;
}

IntensityScaler& FurtherLidars::intensityScaler(std::size_t lidar)
{
  return scalers_.emplace(lidar, IntensityScaler(intensity_scale_)).first->second;
}

std::string FurtherLidars::reasonForNone() const
{
  if (!merge_ || any_taken_)
  {
    return "";
  }
  return numbers_.empty()
             ? "no further lidar has a label like '" + labels_.pattern() + "' (further_lidars)"
             : "no scan of a further lidar is within 0.15 s of one of the first lidar";
}
}  // namespace dyslam
