// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapbuilder/MapListener.h>
#include <dyslam/mapbuilder/MapRun.h>

#include <functional>
#include <string>

namespace dyslam
{
/** Reads all scans, with Frame::sweep_duration.
 * \param purpose as MapListener::beginReading()
 * \return what is wrong with a damaged rawlog, after the scans before the damage. */
[[nodiscard]] std::string readScans(RawlogSource& source,
                                    const std::string& purpose,
                                    MapListener& listener,
                                    const std::function<void(Frame)>& use);

/** The same with the warnings about the recording. */
[[nodiscard]] std::string readScansAndWarn(RawlogSource& source,
                                           const std::string& purpose,
                                           MapListener& listener,
                                           const std::function<void(Frame)>& use);

/** The trajectory of a recording. KITTI's poses are given the times of their scans: a line for each
 * scan that is used, as dyslam writes them, or for each of the file. \return T_map_vehicle; poses
 * of the lidar are transformed by T_vehicle_lidar of the first scan. \throws UserError. */
[[nodiscard]] Trajectory readPoses(const RecordingOnTrajectory& recording, MapListener& listener);
}  // namespace dyslam
