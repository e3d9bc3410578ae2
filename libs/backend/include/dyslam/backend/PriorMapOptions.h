// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <string>

namespace dyslam
{
/** Ini section `[prior_map]`: localisation in a static map of an earlier run. */
struct PriorMapOptions : Options
{
  std::string file;  //!< static map: `.pcd`, `.ply`, or output folder of a run; empty: none
  /** Rough pose of the vehicle at the first scan, frame of the prior map: "x y z yaw pitch roll"
   * [m, deg]; empty: searched for in the whole map. */
  std::string start;
  double start_radius = 10;  //!< largest error of the position of `start`, horizontally [m]
  int interval = 2;          //!< register every n-th keyframe
  double range = 50;         //!< largest range of the points that are registered [m]
  /** Least fraction of a keyframe's points above ground with a correspondence in the map. */
  double min_overlap = 0.5;
  double max_rmse = 0.2;  //!< largest RMSE of the point-to-plane residuals [m]

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
