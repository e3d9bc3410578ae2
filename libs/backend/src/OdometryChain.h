// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/BackendOptions.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/MotionAccumulator.h>
#include <dyslam/core/PathLength.h>

#include "loops/UnseenPath.h"

namespace dyslam
{
class StateArchive;

/** The odometry since the newest keyframe with its covariance, and its path and drift since the
 * start of the run. */
class OdometryChain
{
 public:
  explicit OdometryChain(const BackendOptions& options) : options_(options) {}

  /** Adds the next frame. \return its motion since the frame before */
  Pose add(const Frame& frame, bool is_first);
  /** Whether the newest frame is far enough from the newest keyframe to be one. */
  [[nodiscard]] bool isKeyframeDue() const;
  /** Makes the newest frame the newest keyframe. */
  void beginAtKeyframe();

  /** Motion from the newest keyframe to the newest frame. */
  [[nodiscard]] const MotionAccumulator& sinceKeyframe() const { return since_keyframe_; }
  /** Odometry pose of the newest keyframe. */
  [[nodiscard]] const Pose& keyframePose() const { return T_odom_keyframe_; }
  /** Distance travelled, and that of it that was not measured, see UnseenPath [m]. */
  [[nodiscard]] double pathLength() const { return path_.length(); }
  [[nodiscard]] double unseenLength() const { return unseen_path_.length(); }
  /** Accumulated variances of the steps per axis: translation [m^2], rotation [rad^2]. */
  [[nodiscard]] double drift() const { return drift_; }
  [[nodiscard]] double driftAngle() const { return drift_angle_; }

  void exchangeState(StateArchive& archive);

 private:
  BackendOptions options_;
  Pose T_odom_keyframe_ = Pose::Identity();
  MotionAccumulator since_keyframe_;
  Pose T_odom_previous_ = Pose::Identity();
  PathLength path_;
  UnseenPath unseen_path_;
  double drift_ = 0;
  double drift_angle_ = 0;
};
}  // namespace dyslam
