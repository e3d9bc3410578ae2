// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace dyslam
{
class StateArchive;

/** A position relative to the ellipsoid of WGS84. */
struct GeodeticPosition
{
  double latitude = 0;   //!< north is positive [deg]
  double longitude = 0;  //!< east is positive [deg]
  double height = 0;     //!< above the ellipsoid [m]
};

/** Whether the numbers are finite and a possible latitude and longitude. False for (0, 0), which
 * receivers without a fix report. */
[[nodiscard]] bool isOnEarth(const GeodeticPosition& position);

/** Position of the antenna at one instant, by a satellite receiver. */
struct GnssFix
{
  double stamp = 0;  //!< UNIX time [s]
  GeodeticPosition position;
  // Standard deviations; 0: unknown
  double horizontal_sigma = 0;                        //!< sigma of east and of north, each [m]
  double vertical_sigma = 0;                          //!< sigma of the height [m]
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  //!< antenna's position, vehicle frame [m]

  void exchangeState(StateArchive& archive);
};
}  // namespace dyslam
