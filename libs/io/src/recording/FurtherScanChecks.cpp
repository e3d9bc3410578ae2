// SPDX-License-Identifier: BSD-3-Clause
#include "FurtherScanChecks.h"

#include <algorithm>

#include "RecordingNotes.h"

namespace dyslam
{
namespace
{
/** Notes times of points that a further scan lacks, or alone has. */
void checkTimes(const Scan& part, const Scan& scan, RecordingNotes& notes)
{
  if (part.time.empty() && !scan.time.empty())
  {
    notes.add("the points of '" + part.sensor_label +
              "' have no times: they count as measured at the time stamp of their scan");
  }
  if (!part.time.empty() && scan.time.empty() && scan.size() > 0)
  {
    notes.add("the times of the points of '" + part.sensor_label +
              "' are not used: the first lidar has none");
  }
}
}  // namespace

void FurtherScanChecks::check(const Scan& part,
                              std::size_t lidar,
                              const Scan& scan,
                              RecordingNotes& notes)
{
  checkMounting(part, lidar, scan, notes);
  checkTimes(part, scan, notes);
}

void FurtherScanChecks::checkMounting(const Scan& part,
                                      std::size_t lidar,
                                      const Scan& scan,
                                      RecordingNotes& notes)
{
  mountings_.insert_or_assign(0, Mounting{scan.sensor_label, scan.T_vehicle_lidar});
  mountings_.insert_or_assign(lidar, Mounting{part.sensor_label, part.T_vehicle_lidar});
  const auto same = std::find_if(
      mountings_.begin(), mountings_.end(),
      [&](const auto& other)
      { return other.second.T_vehicle_lidar.matrix() == part.T_vehicle_lidar.matrix(); });
  if (same != mountings_.end() && same->first < lidar)
  {
    notes.add("'" + part.sensor_label + "' has the same sensorPose as '" + same->second.label +
              "': their scans fit only if each has its own mounting on the vehicle");
  }
}
}  // namespace dyslam
