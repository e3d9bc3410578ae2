// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PacketScans.h>
#include <dyslam/packets/VelodyneModels.h>

#include <cmath>
#include <memory>
#include <string>

namespace dyslam
{
struct VelodyneScansOptions
{
  VelodyneModel model = VelodyneModel::automatic;
  std::string calibration_file;  //!< Velodyne's XML or YAML; empty: nominal angles of the model
  double min_range = 0;          //!< range below which returns (vehicle, housing) are dropped [m]
  double cut_azimuth = M_PI;     //!< azimuth where scans are cut, clockwise from ahead [rad]
  bool keep_partial = false;     //!< deliver also incomplete first and last revolutions
  std::string calibration_flag = "--calibration";  //!< flag of calibration_file, for messages
};

/** Scans of the packets of a Velodyne.
 *
 * Lidar frame as MRPT's: x ahead (the sensor's azimuth 0), y left, z up. A revolution is cut where
 * the azimuth passes `cut_azimuth`. The stamp is that of the first firing by SensorClock. Firings
 * without a return are left out.
 */
class VelodyneScans : public PacketScans
{
 public:
  /** \param place of the packets, for messages: the file, or the topic of a bag. */
  VelodyneScans(std::string place, const VelodyneScansOptions& options);
  ~VelodyneScans() override;

  [[nodiscard]] static bool isPacket(const LidarPacket& packet);
  [[nodiscard]] bool takes(const LidarPacket& packet) const override { return isPacket(packet); }
  void add(const LidarPacket& packet) override;
  void finish() override;
  [[nodiscard]] std::optional<Scan> take() override;
  [[nodiscard]] std::string sensor() const override;
  [[nodiscard]] std::vector<std::string> warnings() const override;
  /** The model, which is known once there are some packets. */
  [[nodiscard]] VelodyneModel model() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
