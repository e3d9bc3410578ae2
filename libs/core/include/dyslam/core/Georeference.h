// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/Pose.h>

#include <cstddef>

namespace dyslam
{
/** Pose of the map on the earth. */
struct Georeference
{
  GeodeticPosition origin;  //!< origin of the east-north-up (ENU) axes: the first position used
  Pose T_enu_map = Pose::Identity();
  /** EPSG number of the UTM zone (WGS84) at the map's origin; 0: unknown. */
  int epsg = 0;
  std::size_t fixes = 0;       //!< number of positions used
  double horizontal_rmse = 0;  //!< horizontal RMSE of positions against the trajectory [m]
  double vertical_rmse = 0;    //!< vertical RMSE of positions against the trajectory [m]
  bool fused = false;          //!< the graph was optimised with the positions
};
}  // namespace dyslam
