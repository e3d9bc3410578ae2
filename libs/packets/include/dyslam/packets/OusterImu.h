// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/OusterMetadata.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace dyslam
{
/** Sample of the IMU in an Ouster lidar, in the axes of the IMU. */
struct OusterImuSample
{
  std::uint64_t time = 0;  //!< when the gyroscope was read, by the sensor's clock [ns]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  //!< [rad/s]
  std::optional<Eigen::Vector3d> acceleration;  //!< with gravity [m/s^2]; nothing: not a number
};

/** Whether a datagram is a packet of the IMU of this lidar: of 48 bytes (profile LEGACY), or of the
 * profile ACCEL32_GYRO32_NMEA of firmware 3.2, with the lidar's serial number. */
[[nodiscard]] bool isOusterImuPacket(const std::vector<std::uint8_t>& packet,
                                     const OusterMetadata& metadata);
/** Samples of a packet, one of the profile LEGACY. Those that are invalid, or whose angular
 * velocity is not a number, are left out. \pre isOusterImuPacket(packet, metadata) */
[[nodiscard]] std::vector<OusterImuSample> decodeOusterImu(const std::vector<std::uint8_t>& packet);
}  // namespace dyslam
