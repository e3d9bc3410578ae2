// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/io/RawlogSource.h>

#include <functional>
#include <string>

#include "Arguments.h"

namespace dyslam
{
/** \return what is wrong with a damaged rawlog, after the scans before the damage. */
[[nodiscard]] std::string readScans(RawlogSource& source,
                                    const std::string& what,
                                    bool quiet,
                                    const std::function<void(Frame)>& use);

/** The trajectory asked for. KITTI's poses are given the times of their scans: a line for each scan
 * that is used, as dyslam writes them, or for each of the file. \return T_map_vehicle; poses of the
 * lidar are transformed by T_vehicle_lidar of the first scan. \throws UserError. */
[[nodiscard]] Trajectory readPoses(const Arguments& a);
}  // namespace dyslam
