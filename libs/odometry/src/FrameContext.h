// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/odometry/MotionSensors.h>
#include <dyslam/odometry/ScanClock.h>

#include <optional>

namespace dyslam
{
/** What the steps of the odometry find out about one frame and pass on to the next steps, from
 * Odometry::predict() to Odometry::estimate(). Each frame starts with a new one; none is saved. */
struct FrameContext
{
  /** The interval between the stamps of the previous scan and this one does not fit the sensor's
   * rate. */
  bool interval_doubtful = false;
  /** Frame::dt is longer than ScanClock::max_extrapolation: the motion over it does not show the
   * velocity. */
  bool after_gap = false;
  /** Motion that gyroscope and wheels measured between the two stamps; nothing without samples. */
  std::optional<SensedMotion> sensed;
  /** Information of `sensed` that is fused with Frame::prior, of log(T_sensed^-1 T); zero for
   * components that are not. */
  Matrix6 sensed_information = Matrix6::Zero();
  /** Information of Frame::segmenter_motion that is fused with Frame::prior, of
   * log(T_measured^-1 T); zero if the motion is rejected. */
  Matrix6 segmenter_information = Matrix6::Zero();
  /** The scan matcher fuses the prior: its information is part of Frame::odometry. */
  bool matcher_uses_prior = false;
  /** The scan is the first one to be registered to its local map. */
  bool starts_map = false;
  /** Time between the last usable scan before this one and this one [s]; set by estimate(). */
  double time_without_scan = 0;

  /** Other sensors measure speed and turn rates: the prior holds without scans. */
  [[nodiscard]] bool isDeadReckoned() const
  {
    return sensed_information(0, 0) > 0 && sensed_information(3, 3) > 0;
  }
  /** The prior holds over the time without scans. */
  [[nodiscard]] bool canExtrapolate() const
  {
    return time_without_scan <= ScanClock::max_extrapolation || isDeadReckoned();
  }
  [[nodiscard]] bool acceptedSegmenterMotion() const { return !segmenter_information.isZero(); }
  /** The components of the prior's motion that other sensors measured, and the others of `rest`.
   * \param rest tangent of a motion, [translation, rotation] */
  [[nodiscard]] Pose sensedPart(const Pose& T_prior, const Vector6& rest) const
  {
    const Vector6 of_prior = logSE3(T_prior);
    Vector6 tangent = rest;
    for (Eigen::Index i = 0; i < tangent.size(); ++i)
    {
      tangent[i] = sensed_information(i, i) > 0 ? of_prior[i] : rest[i];
    }
    return expSE3(tangent);
  }
};
}  // namespace dyslam
