// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/Odometry.h>

#include <optional>

#include "FrameContext.h"
#include "MotionPredictor.h"

namespace dyslam
{
/** Decides how much time has passed where the interval between two stamps does not fit the sensor's
 * rate: the interval (scans are missing), or one period (the clock of the stamps was set).
 *
 * The scan itself shows it, registered to the local map from the motions that either would mean.
 */
class IntervalResolver
{
 public:
  /** Both must outlive the object. */
  IntervalResolver(MotionPredictor& predictor, LocalMapRegistration& registration)
      : predictor_(predictor), registration_(registration)
  {
  }

  /** Corrects Frame::dt, clock_offset, prior, T_odom_vehicle and cloud, and the context.
   * \param T_odom_previous pose at the previous scan
   * \param prepare see Odometry */
  void resolve(const Pose& T_odom_previous,
               const PrepareCloud& prepare,
               Frame& frame,
               FrameContext& context);

 private:
  [[nodiscard]] std::optional<Pose> findMotion(const Pose& T_odom_previous,
                                               const PrepareCloud& prepare,
                                               const Frame& frame,
                                               const FrameContext& context);

  MotionPredictor& predictor_;
  LocalMapRegistration& registration_;
};
}  // namespace dyslam
