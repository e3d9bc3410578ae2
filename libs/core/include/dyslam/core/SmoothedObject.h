// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace dyslam
{
/** State of an object at one scan, smoothed over the whole recording. */
struct SmoothedObject
{
  int id = -1;
  /** Estimated by the factor graph, where the front of a box is unknown; else by smoothing its
   * track, where it is known. */
  bool from_graph = true;
  std::size_t scan = 0;  //!< Frame::index
  double stamp = 0;      //!< UNIX time of the scan [s]
  Pose T_map_object = Pose::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< map frame [m/s]
  bool moving = false;                  //!< moving at this scan; from_graph: ever moving
  std::optional<Eigen::Vector3d> size;  //!< size of the box [m], if known better than at the scan
  std::optional<ObjectClass> object_class;  //!< class, if known better than at the scan
  /** Covariance of x, y, z [m^2], yaw [rad^2], map frame, given the ego poses; zero if not
   * `from_graph`. */
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  /** Covariance of the velocity, map frame [m^2/s^2], given the ego poses; zero if static or not
   * `from_graph`. An upper bound where the velocity is the mean of two intervals. */
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
};

/** State of an object at a scan; null if there is none.
 * \param objects ordered by scan, then id */
[[nodiscard]] const SmoothedObject* findSmoothed(const std::vector<SmoothedObject>& objects,
                                                 std::size_t scan,
                                                 int id);
}  // namespace dyslam
