// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RosMessages.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "BodyVelocities.h"
#include "ScanSink.h"

namespace dyslam
{
/** Where the sensors of a bag are mounted. */
struct BagFrames
{
  std::string lidar;         //!< of the scans
  RosTransforms transforms;  //!< of /tf_static
};

/** Passes IMU, wheel odometry and satellite receiver of a bag to the sink, as `imu_topic`,
 * `odometry_topic` and `gnss_topic` select them. */
class BagMotion
{
 public:
  /** \throws UserError if the bag does not have a topic that is selected. */
  BagMotion(const std::string& input,
            const Bag& bag,
            const BagFrames& frames,
            const ScanConverterOptions& options,
            ScanSink& sink);

  /** Positions in Bag::topics() of the scans and of the topics that are selected. */
  [[nodiscard]] std::vector<std::size_t> topicsWith(std::size_t scans) const;
  /** \param message of one of these topics, but not of the scans. \throws UserError if it is
   * damaged. */
  void add(const BagMessage& message);
  /** Whether IMU and wheel odometry, where selected, have had a sample that is as new as a scan.
   * \param stamp of the scan [s], not written yet */
  [[nodiscard]] bool hasSamplesFrom(double stamp) const;
  /** Notes and warnings, after the last message. */
  void report();

 private:
  void addImu(const BagMessage& message);
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
  const BagFrames& frames_;
  const ScanConverterOptions& options_;
  ScanSink& sink_;
  std::optional<std::size_t> imu_;         //!< topic
  std::optional<std::size_t> odometry_;    //!< topic
  std::optional<std::size_t> gnss_;        //!< topic
  std::optional<Pose> T_vehicle_imu_;      //!< from the first sample on
  std::optional<Pose> T_vehicle_body_;     //!< of the odometry's body, from its first message on
  std::optional<Pose> T_vehicle_antenna_;  //!< from the first fix on
  std::string imu_mounting_;               //!< for the note
  std::string body_mounting_;              //!< for the note
  std::string antenna_mounting_;           //!< for the note
  std::size_t imu_left_out_ = 0;
  std::size_t fixes_left_out_ = 0;
  std::size_t twists_left_out_ = 0;
  BodyVelocities velocities_;
};
}  // namespace dyslam
