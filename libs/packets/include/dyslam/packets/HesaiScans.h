// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PacketScans.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
struct HesaiScansOptions
{
  std::string angle_file;     //!< the lidar's angle correction file; empty: nominal angles
  double min_range = 0;       //!< range below which returns (vehicle, housing) are dropped [m]
  double cut_azimuth = M_PI;  //!< azimuth where scans are cut, clockwise from azimuth 0 [rad]
  bool keep_partial = false;  //!< deliver also incomplete first and last revolutions
  std::string calibration_flag = "--calibration";  //!< flag of angle_file, for messages
};

/** Scans of the packets of a Hesai that turns: Pandar40P and 64, PandarXT (16, 32, 32M2X), PandarQT
 * (64, 128), and the packets of version 1.4, which Pandar128, OT128 and JT128 send.
 *
 * Points are in the frame of the maker's drivers: azimuth 0 of the housing lies on y, x is to the
 * right of it, z up. A point has the time of its own shot and the azimuth of the rotor then; those
 * of version 1.4 have time and azimuth of their block, which are within 0.11 ms of their own. With
 * several returns a scan has all that differ. Stamps are by SensorClock.
 */
class HesaiScans : public PacketScans
{
 public:
  /** \param place of the packets, for messages: the file, or the topic of a bag. */
  HesaiScans(std::string place, const HesaiScansOptions& options);
  ~HesaiScans() override;

  [[nodiscard]] static bool isPacket(const LidarPacket& packet);
  [[nodiscard]] bool takes(const LidarPacket& packet) const override;
  void add(const LidarPacket& packet) override;
  void finish() override;
  [[nodiscard]] std::optional<Scan> take() override;
  [[nodiscard]] std::string sensor() const override;
  [[nodiscard]] std::vector<std::string> warnings() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
