// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <optional>
#include <utility>

namespace dyslam
{
/** The poses of the vehicle at two times. */
struct TimedMotion
{
  Pose from = Pose::Identity();
  Pose to = Pose::Identity();
  double dt = 0;  //!< between them [s]; 0: unknown, both are the identity
};

/** Poses of scans along a given trajectory, whose time stamps need not be those of the scans: an
 * INS with a rate of its own, for example.
 *
 * Between two poses that are at most 0.5 s apart the pose is interpolated. Thread-safe. */
class ScanPoses
{
 public:
  /** \param tolerance largest difference of time stamps where the pose cannot be interpolated [s]
   */
  ScanPoses(Trajectory trajectory, double tolerance);

  [[nodiscard]] const Trajectory& trajectory() const { return trajectory_; }

  /** The pose at a time: interpolated, else the nearest one within the tolerance, if any. */
  [[nodiscard]] std::optional<Pose> at(double stamp) const;

  /** The motion during the sweep of a scan, for Preprocessor::prepare().
   *
   * Of a trajectory with one pose per scan, at its time, it is that since the scan before, and
   * where the trajectory does not span the sweep without a gap, that between the nearest poses.
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
