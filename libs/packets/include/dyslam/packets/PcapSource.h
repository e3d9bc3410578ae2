// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Scan.h>
#include <dyslam/packets/VelodyneScans.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct PcapSourceOptions : Options, VelodyneScansOptions
{
  bool imu = false;  //!< keep the samples of the IMU in an Ouster for takeImu()

  void describe(OptionsVisitor& visitor) override;
};

/** Scans out of a network capture (.pcap, .pcapng) of one lidar: of a Velodyne (VelodyneScans), of
 * a Hesai (HesaiScans), or of an Ouster (OusterScans) whose metadata (.json) lie beside the
 * capture, or are named as its calibration file. Packets of other lidars are left out. */
class PcapSource
{
 public:
  /** \throws UserError if the file is missing, no pcap, or has no packets that are read. */
  explicit PcapSource(const std::string& path, const PcapSourceOptions& options = {});
  ~PcapSource();
  PcapSource(PcapSource&&) noexcept;
  PcapSource& operator=(PcapSource&&) noexcept;

  /** Scan of the next revolution; nothing at the end. \throws UserError if the file is damaged. */
  [[nodiscard]] std::optional<Scan> next();
  /** Whether the packets of the IMU in this kind of lidar are decoded: in an Ouster they are. */
  [[nodiscard]] bool readsImu() const;
  /** Number of packets of that IMU that were received, also without PcapSourceOptions::imu. */
  [[nodiscard]] std::size_t imuPackets() const;
  /** With PcapSourceOptions::imu the samples of the IMU in the lidar since the last call, all that
   * were received before the last scan was complete; see PacketScans::takeImu(). */
  [[nodiscard]] std::vector<ImuSample> takeImu();
  /** Name of the lidar, such as "VLP16" or "OS-1-128". */
  [[nodiscard]] std::string sensor() const;
  [[nodiscard]] double progress() const;  //!< fraction of the file that was read, 0 to 1
  /** Notes about files beside the capture that are used, one line each. */
  [[nodiscard]] const std::vector<std::string>& notes() const;
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
