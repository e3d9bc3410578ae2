// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Backend.h>
#include <dyslam/core/Pose.h>
#include <dyslam/tracking/DetectionNoise.h>
#include <dyslam/tracking/Tracker.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Errors added to the true motion between scans, as an odometry makes them. */
struct OdometryNoise
{
  std::string name;
  double per_step = 0;   //!< standard deviation along each axis per step [m] ...
  double per_metre = 0;  //!< ... and this share of the step
  double turn = 0;       //!< standard deviation about each axis per step [rad]
};

/** One sequence of KITTI tracking: detections and labels in the lidar frame, and the ego-motion. */
struct KittiDrive
{
  std::string name;  //!< "0004"
  std::vector<double> stamps;
  std::vector<Pose> truth;  //!< T_world_velo, smoothed from OXTS without any object
  std::vector<std::vector<Detection>> detections;  //!< per scan, as the detector gave them
  std::vector<Pose> visual;  //!< T_odom_velo by the visual odometry in the data, per scan
  std::vector<LabelledBox> labels;
};

/** \param detector folder of `det_<detector>/Car/NNNN.txt`, or "labels" for the labelled boxes
 *  \throws UserError for files that cannot be read. */
[[nodiscard]] KittiDrive readKittiDrive(const std::string& folder,
                                        const std::string& name,
                                        const std::string& detector,
                                        double min_score,
                                        const DetectionNoiseOptions& noise);

/** The motion between scans with errors drawn from `noise`; T_odom_velo, the first is identity. */
[[nodiscard]] std::vector<Pose> noisyOdometry(const std::vector<Pose>& truth,
                                              const OdometryNoise& noise,
                                              std::uint32_t seed);

/** Result of tracker and backend. */
struct KittiSlamRun
{
  std::vector<Pose> trajectory;                     //!< T_map_velo per scan
  std::vector<SmoothedObject> objects;              //!< by scan, then id
  std::vector<std::vector<TrackedObject>> tracked;  //!< per scan, odometry frame
  std::vector<std::string> warnings;
};

/** Runs tracker and backend. \param odometry T_odom_velo per scan \param step_information of the
 * motion from the scan before to each scan, tangent [translation, rotation] [1/m^2, 1/rad^2]; that
 * of the first scan is not used */
[[nodiscard]] KittiSlamRun runKittiSlam(const KittiDrive& drive,
                                        const std::vector<Pose>& odometry,
                                        const std::vector<Matrix6>& step_information,
                                        const TrackerOptions& tracker,
                                        const BackendConfig& backend);

/** Errors of moving vehicles against their labels, RMSE over all scans that observed them. */
struct KittiObjectErrors
{
  std::size_t count = 0;         //!< observations of vehicles faster than 1 m/s
  double observed_position = 0;  //!< of the detections, relative to the vehicle, in the plane [m]
  double tracked_position = 0;   //!< of the tracker, causal
  double smoothed_position = 0;  //!< of the graph
  double difference_speed = 0;   //!< of successive detections [m/s]
  double tracked_speed = 0;
  double smoothed_speed = 0;
};
/** True speeds are the slope of a line through the labels of 11 scans. */
[[nodiscard]] KittiObjectErrors kittiObjectErrors(const KittiDrive& drive,
                                                  const std::vector<Pose>& odometry,
                                                  const KittiSlamRun& run);

/** Speeds of one vehicle over the time since the first scan [s], [m/s]. */
struct KittiVehicleSpeeds
{
  std::vector<std::pair<double, double>> tracked;   //!< causal
  std::vector<std::pair<double, double>> smoothed;  //!< of the graph
};
/** By the id of the vehicle's label. */
[[nodiscard]] std::map<int, KittiVehicleSpeeds> kittiVehicleSpeeds(
    const KittiDrive& drive, const std::vector<Pose>& odometry, const KittiSlamRun& run);

/** Information of each step of an odometry with this noise, one per pose, as runKittiSlam() takes
 * it.
 */
[[nodiscard]] std::vector<Matrix6> stepInformation(const std::vector<Pose>& odometry,
                                                   const OdometryNoise& noise);
}  // namespace dyslam
