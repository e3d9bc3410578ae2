// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/run/RecordedSensor.h>

#include "SensorDescription.h"

namespace dyslam
{
std::string RecordedSensor::summary() const
{
  std::string text = ringsOf(pattern) + ", " + degrees(pattern.lowest, 1) + " to " +
                     degrees(pattern.highest, 1) + " deg";
  if (!turnsFully(pattern))
  {
    text += ", " + degrees(pattern.azimuth_extent, 0) + " deg wide";
  }
  text += ", to " + fixed(pattern.max_range, 0) + " m";
  return text + (period > 0 ? ", " + fixed(1 / period, 1) + " Hz" : "");
}

std::string RecordedSensor::missingTimes(const std::string& deskew) const
{
  const std::string spins = "turns clockwise and begins each scan straight behind";
  if (equal_times && (deskew == "auto" || deskew == "time"))
  {
    return "all points of a scan have the same time: the scans count as deskewed; if they are "
           "not: a recording with the times of the points" +
           (turnsFully(pattern) ? ", or, for a lidar that " + spins + ", preprocess.deskew=azimuth"
                                : std::string());
  }
  if (has_times)
  {
    return {};
  }
  if (pattern.firing_order && (deskew == "auto" || deskew == "time"))
  {
    return "the points have no times: scans are deskewed by the order of their points, which are "
           "stored as they were fired; for scans deskewed before: preprocess.deskew=none";
  }
  if (deskew == "auto" || deskew == "azimuth")
  {
    return "the points have no times: scans are deskewed by azimuth, which is right for a lidar "
           "that " +
           spins + ", as KITTI's; for any other, and for scans deskewed before: " +
           "preprocess.deskew=none";
  }
  std::string text =
      "the points have no times: scans are not deskewed, so that fast motion blurs them";
  if (deskew == "none")
  {
    return text;
  }
  text += "; better: a recording with the times of the points";
  return turnsFully(pattern)
             ? text + ", or, for a lidar that " + spins + ", preprocess.deskew=azimuth"
             : text;
}

std::string RecordedSensor::missingTimes(const Config& config) const
{
  return missingTimes(config.text("preprocess", "deskew").value_or("auto"));
}
}  // namespace dyslam
