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
/** Model of odometry errors, which are added to the true motion between scans. */
struct OdometryNoise
{
  std::string name;
  double per_step = 0;   //!< translation error per step, sigma along each axis [m]
  double per_metre = 0;  //!< further translation error as a share of the step's length
  double turn = 0;       //!< rotation error per step, sigma about each axis [rad]
};

/** One sequence of KITTI tracking: detections and labels in the lidar frame, and the ego-motion. */
struct KittiDrive
{
  std::string name;  //!< "0004"
  std::vector<double> stamps;
  std::vector<Pose> truth;  //!< T_world_velo, smoothed from OXTS without any object
  std::vector<std::vector<Detection>> detections;  //!< detections per scan, lidar frame
  std::vector<Pose> visual;  //!< T_odom_velo by the visual odometry in the data, per scan
  std::vector<LabelledBox> labels;
};

/** Reads a sequence. \param detector detections in `det_<detector>/Car/NNNN.txt`, or "labels" for
 * the labelled boxes \throws UserError for files that cannot be read. */
[[nodiscard]] KittiDrive readKittiDrive(const std::string& folder,
                                        const std::string& name,
                                        const std::string& detector,
                                        double min_score,
                                        const DetectionNoiseOptions& noise);

/** T_odom_velo per scan (the first is identity): the motion between scans of `truth` with errors
 * drawn from `noise`. */
[[nodiscard]] std::vector<Pose> noisyOdometry(const std::vector<Pose>& truth,
                                              const OdometryNoise& noise,
                                              std::uint32_t seed);

/** Result of tracker and backend. */
struct KittiSlamRun
{
  std::vector<Pose> trajectory;                     //!< T_map_velo per scan
  std::vector<SmoothedObject> objects;              //!< smoothed objects by scan, then id
  std::vector<std::vector<TrackedObject>> tracked;  //!< tracked objects per scan, odometry frame
  std::vector<std::string> warnings;
};

/** Runs tracker and backend. \param odometry T_odom_velo per scan \param step_information
 * information of the motion from the previous scan to each scan, tangent [translation, rotation]
 * [1/m^2, 1/rad^2]; the entry of the first scan is not used */
[[nodiscard]] KittiSlamRun runKittiSlam(const KittiDrive& drive,
                                        const std::vector<Pose>& odometry,
                                        const std::vector<Matrix6>& step_information,
                                        const TrackerOptions& tracker,
                                        const BackendConfig& backend);

/** Errors of moving vehicles against their labels, RMSE over all scans that observed them; NaN if
 * none did. */
struct KittiObjectErrors
{
  std::size_t count = 0;         //!< observations of vehicles faster than 1 m/s
  double observed_position = 0;  //!< planar error of the detections relative to the ego [m]
  double tracked_position = 0;   //!< planar error of the tracker (causal) [m]
  double smoothed_position = 0;  //!< planar error of the factor graph [m]
  double difference_speed = 0;   //!< error of the speed between successive detections [m/s]
  double tracked_speed = 0;      //!< error of the speed by the tracker [m/s]
  double smoothed_speed = 0;     //!< error of the speed by the factor graph [m/s]
};
/** Errors of the run's vehicles. Their true speed is the slope of a line through the labels of 11
 * scans. */
[[nodiscard]] KittiObjectErrors kittiObjectErrors(const KittiDrive& drive,
                                                  const std::vector<Pose>& odometry,
                                                  const KittiSlamRun& run);

/** Speeds of one vehicle: pairs of time since the first scan [s] and speed [m/s]. */
struct KittiVehicleSpeeds
{
  std::vector<std::pair<double, double>> tracked;   //!< by the tracker (causal)
  std::vector<std::pair<double, double>> smoothed;  //!< by the factor graph
};
/** Speeds of the vehicles, by the id of their label. */
[[nodiscard]] std::map<int, KittiVehicleSpeeds> kittiVehicleSpeeds(
    const KittiDrive& drive, const std::vector<Pose>& odometry, const KittiSlamRun& run);

/** Information of each step of an odometry with this noise, one per pose: `step_information` of
 * runKittiSlam(). */
[[nodiscard]] std::vector<Matrix6> stepInformation(const std::vector<Pose>& odometry,
                                                   const OdometryNoise& noise);
}  // namespace dyslam
