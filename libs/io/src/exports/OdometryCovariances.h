// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionAccumulator.h>
#include <dyslam/core/Trajectory.h>

#include <optional>
#include <vector>

namespace dyslam
{
constexpr double same_scan_time = 1e-3;  //!< [s] between the stamps of a scan in two files of a run

/** Covariances of the poses and velocities of a run, from those of its odometry's motions.
 *
 * Those of the poses are relative to the first one, by MotionAccumulator along the odometry. They
 * are known only if the trajectory is the odometry: where loops, satellite positions or a prior map
 * have corrected it, its poses have other covariances, which a run does not state. */
class OdometryCovariances
{
 public:
  /** \param trajectory T_map_vehicle \param odometry T_odom_vehicle of the same run \param motions
   * of the run, from its first scan on */
  OdometryCovariances(const Trajectory& trajectory,
                      const Trajectory& odometry,
                      const std::vector<MotionCovariance>& motions);

  /** Covariance of the pose at the stamp of a scan [s], over the tangent of T_map_vehicle
   * ([translation, rotation], in the vehicle's axes, in m and rad); nothing if it is not known. */
  [[nodiscard]] std::optional<Matrix6> ofPose(double stamp) const;
  /** Covariance of the motion from one scan to the next, over its tangent, which is in the axes of
   * the vehicle at the latter; nothing if the stamps [s] are not those of such scans. */
  [[nodiscard]] std::optional<Matrix6> ofMotion(double from, double to) const;

 private:
  /** Number of the motion to the scan at a stamp. */
  [[nodiscard]] std::optional<std::size_t> motionTo(double stamp) const;

  std::vector<double> stamps_;    //!< of the scans, in order [s]
  std::vector<Matrix6> motions_;  //!< by scan, of the motion to it
  std::vector<Matrix6> poses_;    //!< by scan; empty: not known
};

/** Covariance of a pose as messages of ROS have it: of the position in the axes of the parent frame
 * and of a small rotation about these. \param covariance over the tangent of T_parent_child */
[[nodiscard]] Matrix6 inParentAxes(const Matrix6& covariance, const Pose& T_parent_child);
}  // namespace dyslam
