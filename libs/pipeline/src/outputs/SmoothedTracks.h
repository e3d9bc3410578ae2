// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <vector>

namespace dyslam
{
/** The state of an object at a scan; null if the graph does not have it.
 * \param objects by scan, then id */
[[nodiscard]] const SmoothedObject* findSmoothed(const std::vector<SmoothedObject>& objects,
                                                 std::size_t scan,
                                                 int id);

/** The tracked object with position, heading, velocity and covariance of the graph, odometry frame.
 * \param T_odom_map at that scan */
[[nodiscard]] TrackedObject smoothedTrack(const TrackedObject& tracked,
                                          const SmoothedObject& smoothed,
                                          const Pose& T_odom_map);
}  // namespace dyslam
