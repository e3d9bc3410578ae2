// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "BagLidars.h"
#include "BagScans.h"
#include "conversion/ScanSink.h"
#include "recording/BodyVelocities.h"

namespace dyslam
{
/** Passes IMU, wheel odometry and satellite receiver of a bag to the sink, as `imu_topic`,
 * `odometry_topic` and `gnss_topic` select them. */
class BagMotion
{
 public:
  /** \param lidar decodes the packets of the IMU in it; outlives this
   * \throws UserError if the bag does not have a topic that is selected. */
  BagMotion(const std::string& input,
            const Bag& bag,
            BagScans& lidar,
            const BagFrames& frames,
            const ScanConverterOptions& options,
            ScanSink& sink);

  /** Indices in Bag::topics() of the scans and of the selected topics. */
  [[nodiscard]] std::vector<std::size_t> topicsWith(std::size_t scans) const;
  /** Adds a message of one of the selected topics, but not of the scans. \throws UserError if it is
   * damaged. */
  void add(const BagMessage& message);
  /** Whether the selected ones of IMU and wheel odometry have a sample that is as new as a scan.
   * \param stamp stamp of the scan [s], which is not written yet */
  [[nodiscard]] bool hasSamplesFrom(double stamp) const;
  /** Notes and warnings, after the last message. */
  void report();

 private:
  /** \throws UserError if packets are selected as IMU, and the scans are none. */
  void requireLidarPackets(const std::string& input) const;
  [[nodiscard]] bool isImu(const BagTopic& topic) const;
  void addImu(const BagMessage& message);
  void addImuPackets(const BagMessage& message);
  void addTwist(const BagMessage& message);
  void addFix(const BagMessage& message);
  [[nodiscard]] WheelSample wheelSampleOf(const StampedVelocity& body) const;
  [[nodiscard]] std::optional<Pose> mountingOf(const std::string& frame) const;
  void mountImu(const std::string& frame);
  void mountBody(const std::string& frame);
  void reportTopic(const std::string& kind,
                   const std::string& name,
                   const std::string& mounting,
                   const MotionSampleWriter::Written& written);
  void reportLeftOut(const std::string& name, const std::string& what, std::size_t count);
  void noteImuTopics();
  void noteGnssTopics();

  const Bag& bag_;
  BagScans& lidar_;
  const BagFrames& frames_;
  const ScanConverterOptions& options_;
  ScanSink& sink_;
  std::optional<std::size_t> imu_;       //!< index of the topic
  std::optional<std::size_t> odometry_;  //!< index of the topic
  std::optional<std::size_t> gnss_;      //!< index of the topic
  std::optional<Pose> T_vehicle_imu_;    //!< known from the first sample on
  std::optional<Pose> T_vehicle_body_;   //!< body of the odometry, known from its first message on
  std::optional<Pose> T_vehicle_antenna_;  //!< known from the first fix on
  std::string imu_mounting_;               //!< mounting of the IMU, for the note
  std::string body_mounting_;              //!< mounting of the odometry's body, for the note
  std::string antenna_mounting_;           //!< mounting of the antenna, for the note
  std::size_t imu_left_out_ = 0;
  std::size_t fixes_left_out_ = 0;
  std::size_t fixes_swapped_ = 0;  //!< number of these with a longitude as latitude
  std::size_t twists_left_out_ = 0;
  BodyVelocities velocities_;
};
}  // namespace dyslam
