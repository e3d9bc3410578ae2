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

/** Whether it has numbers, a latitude and a longitude. (0, 0) is none: receivers without a fix say
 * so. */
[[nodiscard]] bool isOnEarth(const GeodeticPosition& position);

/** Where a satellite receiver found its antenna at one instant. */
struct GnssFix
{
  double stamp = 0;  //!< UNIX time [s]
  GeodeticPosition position;
  // Standard deviations; 0: the receiver does not say
  double horizontal_sigma = 0;                        //!< of east and of north [m]
  double vertical_sigma = 0;                          //!< [m]
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  //!< vehicle frame [m]

  void exchangeState(StateArchive& archive);
};
}  // namespace dyslam
