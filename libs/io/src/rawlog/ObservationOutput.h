// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/io/GzOutput.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/serialization/CSerializable.h>

#include <string>

namespace dyslam
{
/** Appends an object of MRPT to a file. \throws UserError if it could not be written. */
void writeObject(const mrpt::serialization::CSerializable& object, GzOutput& file);

/** A pose without covariance. \param stamp UNIX time [s] \param T_world_vehicle or that of another
 * frame that does not move */
[[nodiscard]] mrpt::obs::CObservationRobotPose robotPose(double stamp,
                                                         const std::string& label,
                                                         const Pose& T_world_vehicle);
}  // namespace dyslam
