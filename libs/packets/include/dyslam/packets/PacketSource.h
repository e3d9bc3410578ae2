// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Scan.h>
#include <dyslam/packets/PacketInput.h>
#include <dyslam/packets/VelodyneScans.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct PacketSourceOptions : Options, VelodyneScansOptions
{
  bool imu = false;  //!< keep the samples of the IMU in an Ouster for takeImu()

  void describe(OptionsVisitor& visitor) override;
};

/** Scans out of the packets of one lidar: of a Velodyne (VelodyneScans), of a Hesai (HesaiScans),
 * or of an Ouster (OusterScans) whose metadata (.json) are named as its calibration file, or lie
 * beside a capture. Packets of other lidars are left out. */
class PacketSource
{
 public:
  /** Reads up to the first scan. \throws UserError if there are no packets that are read. */
  explicit PacketSource(std::unique_ptr<PacketInput> input,
                        const PacketSourceOptions& options = {});
  ~PacketSource();
  PacketSource(PacketSource&&) noexcept;
  PacketSource& operator=(PacketSource&&) noexcept;

  /** Scan of the next revolution; nothing at the end. \throws UserError if the input is damaged. */
  [[nodiscard]] std::optional<Scan> next();
  /** Name of the input. */
  [[nodiscard]] const std::string& name() const;
  /** Whether the packets of the IMU in this kind of lidar are decoded: in an Ouster they are. */
  [[nodiscard]] bool readsImu() const;
  /** Number of packets of that IMU that were received, also without PacketSourceOptions::imu. */
  [[nodiscard]] std::size_t imuPackets() const;
  /** With PacketSourceOptions::imu the samples of the IMU in the lidar since the last call, all
   * that were received before the last scan was complete; see PacketScans::takeImu(). */
  [[nodiscard]] std::vector<ImuSample> takeImu();
  /** Name of the lidar, such as "VLP16" or "OS-1-128". */
  [[nodiscard]] std::string sensor() const;
  [[nodiscard]] double progress() const;  //!< of the input
  /** Notes about files beside the input that are used, one line each. */
  [[nodiscard]] const std::vector<std::string>& notes() const;
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
