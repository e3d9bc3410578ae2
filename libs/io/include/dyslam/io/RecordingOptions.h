// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** Options of scans2rawlog that dyslam has, too, for a recording of any kind. */
struct RecordingOptions
{
  std::string topic;  //!< of a bag's scans; empty: the one with the most
  /** Of a bag's further lidars, placed by `/tf_static` relative to the first; see furtherLabels().
   */
  std::vector<std::string> further_topics;
  std::string imu_topic;       //!< of a bag's IMU; empty: none
  std::string odometry_topic;  //!< of the speeds of a bag's wheels; empty: none
  std::string gnss_topic;      //!< of a bag's satellite receiver; empty: none
  std::string sensor;  //!< for packets the VelodyneModel by name, VLP16; else the scans' label
  /** For packets: Velodyne XML or YAML, or the metadata of an Ouster (.json); empty: the model's
   * default, or the metadata beside the capture or in the bag. */
  std::string calibration;
  std::string sensor_pose;  //!< T_vehicle_lidar: x y z yaw pitch roll [m, deg]; empty: identity
  std::string base_frame;   //!< of the vehicle in a bag's `/tf_static`, instead of sensor_pose
  double dt = 0;            //!< seconds between scans; 0: the recording's times, else 0.1

  /** Sensor label of scans that have none of their own. */
  [[nodiscard]] std::string firstLabel() const { return sensor.empty() ? "lidar" : sensor; }
  /** Sensor labels that the scans of further_topics get: "rear_points" of "/rear/points". One that
   * is that of the first lidar or of a topic before gets a number: "rear_points_2". */
  [[nodiscard]] std::vector<std::string> furtherLabels() const;
  /** RawlogSourceOptions::further_lidars for the scans of further_topics; empty without.
   * \throws UserError if it is too long for that option. */
  [[nodiscard]] std::string furtherLidars() const;
  /** What is given as words of a command line: "--topic=/points". */
  [[nodiscard]] std::vector<std::string> words() const;
  /** The flag of an option that is given, for messages: "--topic"; empty if none is. */
  [[nodiscard]] std::string givenFlag() const;
  /** Whether one of these options has this flag. */
  [[nodiscard]] static bool hasFlag(const std::string& flag);
  /** The flag of an option that is given and works with bags only; empty if none is. */
  [[nodiscard]] std::string givenFlagOfBags() const;
  /** \throws UserError for an option that is given and does not apply to KITTI's folders. */
  void requireFittingKitti() const;
};
}  // namespace dyslam
