// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/Motion.h>
#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace dyslam
{
class StateArchive;

/** The data of one scan in the pipeline: each stage reads what earlier stages wrote and fills in
 * its own part.
 *
 * Stages exchange data through it alone.
 */
struct Frame
{
  // Source
  std::size_t index = 0;  //!< number of the scan in the recording, from 0
  Scan scan;
  std::optional<Pose> T_world_vehicle_truth;  //!< ground truth, where the recording has it
  // Samples of other sensors recorded since the previous scan, with stamps of the clock of
  // scan.stamp; their times may overlap with those of neighbouring frames
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<GnssFix> gnss;

  // Odometry::predict
  double dt = 0;  //!< time since the previous scan [s]; 0 for the first scan
  /** Duration of the revolution by the sensor's rate [s]: dt unless scans are missing; 0 for the
   * first scan. */
  double sweep_duration = 0;
  /** scan.stamp minus the time of a clock that was never adjusted during the recording [s]. */
  double clock_offset = 0;
  MotionPrior prior;  //!< prior of `motion`; Odometry::estimate fuses segmenter_motion with it

  // Preprocessing
  Cloud cloud;

  // Segmentation; the vectors have one value per cloud point, or none if the stage is off
  std::vector<float> moving_probability;  //!< in [0, 1]
  /** Ego-motion relative to the static world that the segmenter found by itself. */
  std::optional<MotionEstimate> segmenter_motion;
  /** Appearance prior: probability in [0, 1] that a point belongs to a static object, from its
   * appearance alone. Given only until enough scans have been seen to observe motion; else
   * empty. */
  std::vector<float> static_prior;

  /** The moving/static decision that all later stages use, per cloud point; empty where nothing was
   * decided. */
  std::vector<bool> moving;

  // Odometry::estimate
  MotionEstimate odometry;                 //!< motion estimated by the scan matcher
  bool odometry_accepted = false;          //!< `odometry` is used as initial guess or as `motion`
  std::string odometry_rejection;          //!< why `odometry` was rejected; empty if accepted
  std::vector<float> static_confidence;    //!< scan matcher's weight per cloud point in [0, 1]
  MotionEstimate motion;                   //!< motion since the previous scan, used by later stages
  Pose T_odom_vehicle = Pose::Identity();  //!< from Odometry::predict to estimate: predicted

  // Detection and tracking
  /** Per cloud point: it is `moving` because it is in the predicted box of a dynamic object
   * (Tracker::markPredicted), not by segmentation; else empty. */
  std::vector<bool> moving_by_prediction;
  std::vector<Detection> detections;
  std::vector<TrackedObject> objects;
  /** Per cloud point: it belongs to an object that was reported by the first tracking. Only where
   * `objects` are those of the second tracking (`pipeline.hindsight_tracking`); else empty. */
  std::vector<bool> reported_before;

  // Backend
  bool is_keyframe = false;
  Pose T_map_odom = Pose::Identity();

  /** Stamp of the scan by a clock that was never adjusted [s]: differences are elapsed time. */
  [[nodiscard]] double time() const { return scan.stamp - clock_offset; }
  [[nodiscard]] Pose T_map_vehicle() const { return T_map_odom * T_odom_vehicle; }
  /** Indices in `cloud` of the points of an object's detection, in `detections`; none if it was not
   * observed. */
  [[nodiscard]] const std::vector<std::uint32_t>& pointsOf(const TrackedObject& object) const;
  [[nodiscard]] bool isMoving(std::size_t point) const
  {
    return point < moving.size() && moving[point];
  }

  /** All fields above, in their order; Frame.cpp does not compile if one is missing. */
  [[nodiscard]] auto members()
  {
    return std::tie(index, scan, T_world_vehicle_truth, imu, wheels, gnss, dt, sweep_duration,
                    clock_offset, prior, cloud, moving_probability, segmenter_motion, static_prior,
                    moving, odometry, odometry_accepted, odometry_rejection, static_confidence,
                    motion, T_odom_vehicle, moving_by_prediction, detections, objects,
                    reported_before, is_keyframe, T_map_odom);
  }
  /** Saves or loads all fields. */
  void exchangeState(StateArchive& archive);
};

/** Classifies the points for all later stages: sets Frame::moving, one value per cloud point, from
 * Frame::moving_probability. Without probabilities all points are static. */
void decideMoving(Frame& frame, double moving_threshold);
}  // namespace dyslam
