// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
#include <dyslam/core/Scan.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
enum class VelodyneModel
{
  automatic,  //!< recognised from the packets
  vlp16,
  hdl32e,
  hdl64e
};

struct PcapSourceOptions : Options
{
  VelodyneModel model = VelodyneModel::automatic;
  std::string calibration_file;  //!< Velodyne's XML or YAML; empty: MRPT's default of the model
  double min_range = 0;          //!< nearer returns (vehicle, housing) are dropped [m]
  double cut_azimuth = M_PI;     //!< where scans are cut, clockwise from ahead [rad]; the rear
  bool keep_partial = false;     //!< also deliver the incomplete first and last revolution

  void describe(OptionsVisitor& visitor) override;
};

/** Revolutions of a Velodyne lidar out of a network capture (.pcap, .pcapng).
 *
 * Lidar frame as MRPT's: x ahead (the sensor's azimuth 0), y left, z up. A revolution is cut where
 * the azimuth passes `cut_azimuth`. Points have time within the scan, ring and intensity; firings
 * without a return are left out. Stamps are of the sensor's clock, aligned with that of the capture
 * at the first packet, and again where the sensor's clock jumps by more than 1 s or back.
 */
class PcapSource
{
 public:
  /** \throws UserError if the file is missing, no pcap, or has no Velodyne packets. */
  explicit PcapSource(const std::string& path, const PcapSourceOptions& options = {});
  ~PcapSource();
  PcapSource(PcapSource&&) noexcept;
  PcapSource& operator=(PcapSource&&) noexcept;

  /** The next revolution, nothing at the end. \throws UserError if the file is damaged. */
  [[nodiscard]] std::optional<Scan> next();
  [[nodiscard]] VelodyneModel model() const;
  [[nodiscard]] double progress() const;  //!< 0 to 1
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
