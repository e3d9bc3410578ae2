// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/OusterMetadata.h>
#include <dyslam/packets/PacketScans.h>

#include <memory>
#include <string>

namespace dyslam
{
/** Scans of the packets of an Ouster OS0, OS1, OS2 or OSDome, of all firmware with one of the
 * profiles of OusterProfile.
 *
 * Points are in the frame of the sensor (`os_sensor`): x to its front, opposite to the connector,
 * y left, z up from the base. A scan is a frame of the sensor, which begins at the connector; with
 * dual returns it has both. Points lie behind each other column by column as received, with the
 * column's time, the beam's rank by its angle as ring (0 the lowest) and the reflectivity as
 * intensity, 0 to 1. Stamps are by SensorClock.
 *
 * Samples of the IMU in the lidar (OusterImu.h) are left out before the first packet of the lidar,
 * which sets the clock, and if their time is more than 1 s from that of the lidar's last one.
 *
 * Geometry: Ouster, Software User Manual, "Lidar Range to XYZ".
 */
class OusterScans : public PacketScans
{
 public:
  /** \param place of the packets, for messages: the file, or the topic of a bag. */
  OusterScans(std::string place, const OusterMetadata& metadata, bool keep_partial);
  ~OusterScans() override;

  /** Size of a data packet [bytes]. */
  [[nodiscard]] static std::size_t packetSize(const OusterMetadata& metadata);

  [[nodiscard]] bool takes(const LidarPacket& packet) const override;
  void add(const LidarPacket& packet) override;
  void finish() override;
  [[nodiscard]] std::optional<Scan> take() override;
  [[nodiscard]] bool readsImu() const override { return true; }
  [[nodiscard]] bool takesImu(const LidarPacket& packet) const override;
  void addImu(const LidarPacket& packet) override;
  [[nodiscard]] std::vector<ImuSample> takeImu() override;
  [[nodiscard]] std::string sensor() const override;
  [[nodiscard]] std::vector<std::string> warnings() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
