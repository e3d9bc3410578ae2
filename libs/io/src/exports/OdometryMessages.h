// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/RosWriter.h>

#include <optional>
#include <string>

#include "OdometryCovariances.h"

namespace dyslam
{
/** The poses of a trajectory as `nav_msgs/Odometry`, with velocities and, of a run, covariances. */
class OdometryMessages
{
 public:
  /** \param poses T_map_vehicle, outlive this \param motions as in BagExportOptions \throws
   * UserError for files that cannot be read. */
  OdometryMessages(const Trajectory& poses, const std::string& motions);

  /** The message of a pose at a scan, with the velocity in the vehicle's axes by the two poses up
   * to it, at the start by the first two. \throws UserError as odometryMessage() */
  [[nodiscard]] std::string of(const RosPose& pose) const;

 private:
  const Trajectory& poses_;
  std::optional<OdometryCovariances> covariances_;
};
}  // namespace dyslam
