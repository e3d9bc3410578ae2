// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/RecordingKind.h>

#include <string>
#include <vector>

namespace dyslam
{
/** A value of RecordingOptions::further_topics. */
struct FurtherTopicOption
{
  std::string topic;
  std::string calibration;  //!< as RecordingOptions::calibration
};
/** \param value "TOPIC" or "TOPIC=FILE" \throws UserError if nothing is behind the =. */
[[nodiscard]] FurtherTopicOption splitFurtherTopic(const std::string& value);

/** Whether scans are already deskewed; deskewed scans get point times of 0. */
enum class ScansDeskewed
{
  automatic,  //!< scans of KITTI odometry are deskewed
  yes,
  no
};

/** Options of the converters that dyslam also has, for a recording of any kind. */
struct RecordingOptions
{
  std::string topic;  //!< topic of a bag's scans; empty: the one with the most
  /** Topics of a bag's further lidars, placed by `/tf_static` relative to the first one, as "TOPIC"
   * or "TOPIC=FILE" with the calibration of their packets; see furtherLabels(). */
  std::vector<std::string> further_topics;
  std::string imu_topic;       //!< topic of a bag's IMU; empty: none
  bool imu = false;            //!< also the IMU in the Ouster of a capture
  std::string odometry_topic;  //!< topic of a bag's wheel odometry; empty: none
  std::string gnss_topic;      //!< topic of a bag's satellite receiver; empty: none
  std::string sensor;          //!< for packets: name of the VelodyneModel; else: label of the scans
  /** For packets: Velodyne XML or YAML, or the metadata of an Ouster (.json); empty: the model's
   * default, or the metadata beside the capture or in the bag. */
  std::string calibration;
  std::string sensor_pose;  //!< T_vehicle_lidar: x y z yaw pitch roll [m, deg]; empty: identity
  std::string base_frame;   //!< vehicle frame in a bag's `/tf_static`, instead of sensor_pose
  double dt = 0;            //!< time between scans [s]; 0: the recording's times, else 0.1
  std::string
      bin_layout;    //!< of the .bin files of a folder, see readBin(); empty: by their content
  double scale = 1;  //!< of the coordinates of a bag's or folder's clouds [m]; millimetres: 0.001
  ScansDeskewed deskewed = ScansDeskewed::automatic;  //!< of KITTI's scans
  bool vertical_angle_correction = false;             //!< as KittiConverterOptions has it

  /** Sensor label of scans without a label of their own. */
  [[nodiscard]] std::string firstLabel() const { return sensor.empty() ? "lidar" : sensor; }
  /** Sensor labels for the scans of further_topics: "rear_points" for "/rear/points". A label that
   * the first lidar or an earlier topic has gets a number: "rear_points_2". */
  [[nodiscard]] std::vector<std::string> furtherLabels() const;
  /** RawlogSourceOptions::further_lidars for the scans of further_topics; empty without.
   * \throws UserError if it is too long for that option. */
  [[nodiscard]] std::string furtherLidars() const;
  /** The files that the options name. */
  [[nodiscard]] std::vector<std::string> files() const;
  /** The same options, for another working folder. */
  [[nodiscard]] RecordingOptions withAbsolutePaths() const;
  /** The given options as words of a command line: "--topic=/points". */
  [[nodiscard]] std::vector<std::string> words() const;
  /** Flag of a given option, for messages: "--topic"; empty if none is given. */
  [[nodiscard]] std::string givenFlag() const;
  /** Whether one of these options has this flag. */
  [[nodiscard]] static bool hasFlag(const std::string& flag);
  /** \param kind of the recording, not unknown
   * \throws UserError for a given option that does not apply to recordings of this kind, and for a
   * wrong bin_layout. */
  void requireFitting(RecordingKind kind) const;
};
}  // namespace dyslam
