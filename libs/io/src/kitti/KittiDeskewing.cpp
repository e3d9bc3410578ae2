// SPDX-License-Identifier: BSD-3-Clause
#include "KittiDeskewing.h"

#include <dyslam/core/Deskew.h>
#include <dyslam/core/PointTimes.h>
#include <dyslam/formats/ScanFiles.h>

#include <utility>

namespace dyslam
{
bool isSwept(const Scan& scan)
{
  constexpr double instant = 1e-3;  // longest sweep that hardly distorts [s]
  return timeExtent(scan.time).value_or(TimeExtent()).duration() > instant;
}

void KittiDeskewing::add(const Scan& scan, const Pose& T_world_lidar, const std::string& path)
{
  std::optional<Motion> motion;
  if (waiting_ && scan.stamp > waiting_->scan.stamp)
  {
    motion = Motion{waiting_->T_world_lidar.inverse() * T_world_lidar,
                    scan.stamp - waiting_->scan.stamp};
  }
  writeWaiting(motion);
  before_ = motion;
  waiting_ = Item{scan, T_world_lidar, path};
}

void KittiDeskewing::finish()
{
  writeWaiting(std::nullopt);
  waiting_.reset();
}

/** \param after motion from the waiting scan to the next */
void KittiDeskewing::writeWaiting(const std::optional<Motion>& after)
{
  constexpr double gap = 1.5;  // ratio of two intervals above which a scan is missing in the longer
  if (!waiting_)
  {
    return;
  }
  Scan& scan = waiting_->scan;
  const bool has_times = scan.time.size() == scan.size() && timeExtent(scan.time).has_value();
  without_times_ += has_times ? 0U : 1U;
  if (has_times && (before_ || after))
  {
    Motion earlier = before_ ? *before_ : *after;
    Motion later = after ? *after : *before_;
    earlier = earlier.dt > gap * later.dt ? later : earlier;
    later = later.dt > gap * earlier.dt ? earlier : later;
    const SweepMotion earlier_sweep(earlier.T_start_end, 0);
    const SweepMotion later_sweep(later.T_start_end, 0);
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      const float time = scan.time[i];
      if (isPossibleTime(time) && scan.points[i].allFinite() && !scan.points[i].isZero())
      {
        const bool is_later = time >= 0;
        const double dt = is_later ? later.dt : earlier.dt;
        scan.points[i] = (is_later ? later_sweep : earlier_sweep)
                             .toReference(scan.points[i], time / static_cast<float>(dt));
      }
    }
  }
  writeBin(waiting_->path, scan.points, scan.intensity);
}
}  // namespace dyslam
