// SPDX-License-Identifier: BSD-3-Clause
#include "MetricPositions.h"

#include <dyslam/base/Error.h>
#include <dyslam/core/GnssFix.h>
#include <dyslam/formats/PositionFile.h>
#include <dyslam/mrpt/Geodesy.h>

#include <optional>
#include <utility>

namespace dyslam
{
Trajectory readMetricPositions(const std::string& path, const NoteSink& note)
{
  PositionFile file = readPositions(path);
  if (!file.clock.empty())
  {
    note(path + ": its times are " + file.clock +
         ", and are converted to UTC; for estimates with another clock there is --time-offset");
  }
  if (file.axes == PositionAxes::local)
  {
    return std::move(file.positions);
  }
  Trajectory of_enu;
  std::optional<GeodeticPosition> origin;
  for (const StampedPose& measured : file.positions)
  {
    const Eigen::Vector3d& numbers = measured.pose.translation();
    const GeodeticPosition position = file.axes == PositionAxes::geocentric
                                          ? fromGeocentric(numbers)
                                          : GeodeticPosition{numbers.x(), numbers.y(), numbers.z()};
    if (isOnEarth(position))
    {
      origin = origin.value_or(position);
      Pose pose = Pose::Identity();
      pose.translation() = toEnu(position, *origin);
      of_enu.push_back(measured.stamp, pose);
    }
  }
  if (of_enu.empty())
  {
    throw UserError(path +
                    (file.axes == PositionAxes::geocentric
                         ? ": none of its positions is a place on the earth"
                         : ": none of its latitudes and longitudes [deg] is a place on the earth"));
  }
  return of_enu;
}
}  // namespace dyslam
