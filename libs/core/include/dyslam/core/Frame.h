// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** A relative motion and how far to trust it. */
struct MotionEstimate
{
  Pose T_previous_current =
      Pose::Identity();  //!< takes this scan's vehicle frame to the previous one's
  /** Of r = log(T_measured^-1 T), [translation, rotation]; units 1/m^2, 1/rad^2. */
  Matrix6 information = Matrix6::Identity();
  bool converged = false;
  int iterations = 0;
  std::size_t inliers = 0;
  double rmse = 0;     //!< of the inliers' residuals [m]
  std::string reason;  //!< why it did not converge; empty if it did
};

/** What travels down the pipeline: each stage reads what earlier ones wrote and fills its own part.
 */
struct Frame
{
  // Source
  std::size_t index = 0;  //!< number of the scan in the recording, from 0
  Scan scan;
  std::optional<Pose> T_world_vehicle_truth;  //!< ground truth, where the recording has it

  // Preprocessing
  Cloud cloud;

  /** What the motions before say about the motion since the scan before; none where that is little,
   * as at the start. */
  std::optional<Pose> T_previous_predicted;

  // DySeg: one per cloud point, or empty if the stage is off
  std::vector<float> moving_probability;

  // Odometry
  MotionEstimate odometry;
  bool odometry_heeded = false;          //!< its motion was believed, not only the predicted one
  std::vector<float> static_confidence;  //!< one per cloud point in [0, 1], or empty

  // Refinement: the pose that later stages use
  MotionEstimate refined;
  Pose T_odom_vehicle = Pose::Identity();

  // Detection and tracking
  std::vector<Detection> detections;
  std::vector<TrackedObject> objects;

  // Backend
  bool is_keyframe = false;
  Pose T_map_odom = Pose::Identity();

  [[nodiscard]] Pose T_map_vehicle() const { return T_map_odom * T_odom_vehicle; }
};
}  // namespace dyslam
