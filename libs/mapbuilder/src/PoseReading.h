// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/mapbuilder/MapListener.h>
#include <dyslam/mapbuilder/MapRun.h>

namespace dyslam
{
/** The trajectory of a recording. KITTI's poses are given the times of their scans: a line for each
 * scan that is used, as dyslam writes them, or for each of the file. \return T_map_vehicle, of
 * the levelled vehicle; poses of the lidar are transformed by T_vehicle_lidar of the first scan.
 * \throws UserError. */
[[nodiscard]] Trajectory readPoses(const RecordingOnTrajectory& recording, MapListener& listener);
}  // namespace dyslam
