// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <optional>
#include <utility>

namespace dyslam
{
/** Poses of the vehicle at two times. */
struct TimedMotion
{
  Pose from = Pose::Identity();
  Pose to = Pose::Identity();
  double dt = 0;  //!< time between the poses [s]; 0: unknown, both are the identity
};

/** Poses of scans along a given trajectory with other stamps than the scans, for example of an INS.
 *
 * Between two poses that are at most 0.5 s apart the pose is interpolated. Thread-safe. */
class ScanPoses
{
 public:
  /** \param tolerance largest difference of stamps if the pose can't be interpolated [s] */
  ScanPoses(Trajectory trajectory, double tolerance);

  [[nodiscard]] const Trajectory& trajectory() const { return trajectory_; }

  /** Pose at a stamp [s]: interpolated, else the nearest one within the tolerance, else nothing. */
  [[nodiscard]] std::optional<Pose> at(double stamp) const;

  /** The motion during the sweep of a scan, for Preprocessor::prepare().
   *
   * If the trajectory has one pose per scan, at its stamp: the motion since the previous scan. If
   * the trajectory has a gap during the sweep: the motion between the nearest poses.
   * \param span Preprocessor::sweepSpan() of the scan */
  [[nodiscard]] TimedMotion motionDuring(double stamp, const std::pair<double, double>& span) const;

 private:
  [[nodiscard]] std::optional<Pose> interpolated(double stamp) const;
  [[nodiscard]] std::optional<TimedMotion> between(double begin, double end) const;
  [[nodiscard]] TimedMotion nearestStep(double stamp) const;

  Trajectory trajectory_;
  double tolerance_;
  double step_ = 0;  // median time between poses [s]
};
}  // namespace dyslam
