// SPDX-License-Identifier: BSD-3-Clause
#include "FurtherLidars.h"

#include <dyslam/mrpt/Conversions.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "ObservationScans.h"

namespace dyslam
{
FurtherLidars::FurtherLidars(const std::string& labels, double intensity_scale)
    : labels_("further_lidars", labels), wanted_(!labels.empty()), intensity_scale_(intensity_scale)
{
}

bool FurtherLidars::areNamed(const std::string& label) const
{
  return wanted_ && labels_.fits(label);
}

void FurtherLidars::holdTimeRing(const mrpt::obs::CObservation::Ptr& observation)
{
  std::string label = observation->sensorLabel;
  label.resize(label.size() - std::string(time_ring_suffix).size());
  if (areNamed(label))
  {
    time_rings_[label] = observation;
  }
}

void FurtherLidars::hold(const mrpt::obs::CObservation::Ptr& observation, double clock_shift)
{
  HeldScan scan;
  scan.observation = observation;
  scan.time_ring = std::exchange(time_rings_[observation->sensorLabel], nullptr);
  scan.lidar = numbers_.emplace(observation->sensorLabel, numbers_.size() + 1).first->second;
  scan.clock_shift = clock_shift;
  scan.stamp = toStamp(observation->timestamp) + clock_shift;
  held_.push_back(std::move(scan));
}

std::vector<FurtherLidars::HeldScan> FurtherLidars::takeFor(double stamp,
                                                            std::optional<double> next)
{
  std::vector<HeldScan> taken;
  std::deque<HeldScan> left;
  for (HeldScan& scan : held_)
  {
    if (next && scan.stamp >= 0.5 * (stamp + *next))
    {
      left.push_back(std::move(scan));
    }
    else if (std::abs(scan.stamp - stamp) <= farthest)
    {
      taken.push_back(std::move(scan));
    }
    else
    {
      ++dropped_;
    }
  }
  held_ = std::move(left);
  std::stable_sort(taken.begin(), taken.end(),
                   [](const HeldScan& a, const HeldScan& b)
                   { return std::tie(a.lidar, a.stamp) < std::tie(b.lidar, b.stamp); });
  any_taken_ = any_taken_ || !taken.empty();
  return taken;
}

void FurtherLidars::metScan(double stamp, bool taken)
{
  if (left_out_)
  {
    const double border = 0.5 * (*left_out_ + stamp);
    held_.erase(std::remove_if(held_.begin(), held_.end(),
                               [border](const HeldScan& scan) { return scan.stamp < border; }),
                held_.end());
  }
  left_out_ = taken ? std::nullopt : std::optional<double>(stamp);
}

IntensityScaler& FurtherLidars::intensityScaler(std::size_t lidar)
{
  return scalers_.emplace(lidar, IntensityScaler(intensity_scale_)).first->second;
}

std::string FurtherLidars::reasonForNone() const
{
  if (!wanted_ || any_taken_)
  {
    return "";
  }
  return numbers_.empty()
             ? "no further lidar has a label like '" + labels_.pattern() + "' (further_lidars)"
             : "no scan of a further lidar is within 0.15 s of one of the first lidar";
}
}  // namespace dyslam
