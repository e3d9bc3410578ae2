// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/PriorMapOptions.h>

namespace dyslam
{
void PriorMapOptions::describe(OptionsVisitor& visitor)
{
  visitor.text("file", file,
               "static map in which the run is localised: .pcd, .ply, or the output folder of a "
               "run; empty: none");
  visitor.text("start", start,
               "rough pose of the vehicle at the first scan in this map, x y z yaw pitch roll [m, "
               "deg]; empty: searched for in the whole map");
  visitor.real("start_radius", start_radius, 0, 30,
               "largest error of the position of start, horizontally [m]");
  visitor.integer("interval", interval, 1, 1000, "register every n-th keyframe to the prior map");
  visitor.real("range", range, 10, 130, "largest range of the points that are registered [m]");
  visitor.real("min_overlap", min_overlap, 0, 1,
               "least fraction of a keyframe's points above ground with a correspondence in the "
               "prior map");
  visitor.real("max_rmse", max_rmse, 0, 10, "largest RMSE of the point-to-plane residuals [m]");
}
}  // namespace dyslam
