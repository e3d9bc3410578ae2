// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/Pose.h>

#include <cstddef>

namespace dyslam
{
/** Where the map is on the earth. */
struct Georeference
{
  GeodeticPosition origin;  //!< of the east-north-up axes: the first position used
  Pose T_enu_map = Pose::Identity();
  /** Number of the coordinate reference system of UTM on WGS84 at the map's origin; 0: unknown. */
  int epsg = 0;
  std::size_t fixes = 0;       //!< positions used
  double horizontal_rmse = 0;  //!< of the positions from the trajectory [m]
  double vertical_rmse = 0;    //!< [m]
  bool fused = false;          //!< the graph was optimised with the positions
};
}  // namespace dyslam
