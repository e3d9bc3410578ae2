// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Scan.h>
#include <dyslam/formats/Bag.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Makes scans of the messages of one topic of a bag. */
class BagScans
{
 public:
  BagScans() = default;
  virtual ~BagScans() = default;
  BagScans(const BagScans&) = delete;
  BagScans& operator=(const BagScans&) = delete;

  /** Adds a message. \return the scans that it completes: one for a cloud, one or none for packets
   * \throws UserError naming the message and the problem. */
  [[nodiscard]] virtual std::vector<Scan> add(const BagMessage& message) = 0;
  /** Adds a message with packets of the IMU in the lidar. \return its samples, by the clock of the
   * scans; T_vehicle_imu is their pose in the frame of the points; none of other packets
   * \throws UserError naming the message and the problem. */
  [[nodiscard]] virtual std::vector<ImuSample> addImu(const BagTopic& /*topic*/,
                                                      const BagMessage& /*message*/)
  {
    return {};
  }
  /** To be called after the last message. \return the remaining scans \throws UserError. */
  [[nodiscard]] virtual std::vector<Scan> finish() { return {}; }
  /** Interpretations of the messages, one line each. */
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
};

/** Options of one lidar whose packets are decoded. */
struct PacketOptions
{
  std::string sensor;       //!< name of the VelodyneModel; empty: by the packets
  std::string calibration;  //!< as RecordingOptions::calibration
  std::string calibration_flag = "--calibration";  //!< flag of that file, for messages
  bool keep_partial = false;                       //!< also incomplete first and last revolutions
};

/** Reader for a topic of clouds, or of the packets of a Velodyne, Hesai or Ouster. \param bag
 * outlives it; it is read up to the metadata of an Ouster. \throws UserError for options that do
 * not fit, or if the metadata of an Ouster are missing. */
[[nodiscard]] std::unique_ptr<BagScans> makeBagScans(const std::string& input,
                                                     Bag& bag,
                                                     std::size_t topic,
                                                     const PacketOptions& options);
}  // namespace dyslam
