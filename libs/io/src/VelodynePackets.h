// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <mrpt/obs/VelodyneCalibration.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
constexpr std::size_t velodyne_packet_size = 1206;
constexpr std::size_t velodyne_blocks = 12;

/** The fixed parts of one data packet, which hold for every model. */
struct VelodynePacketView
{
  const std::uint8_t* bytes = nullptr;  //!< velodyne_packet_size of them

  [[nodiscard]] std::uint16_t header(std::size_t block) const { return u16(block * 100); }
  /** Clockwise from ahead [0.01 deg]. */
  [[nodiscard]] std::uint16_t azimuth(std::size_t block) const { return u16(block * 100 + 2); }
  [[nodiscard]] std::uint16_t range(std::size_t block, std::size_t k) const
  {
    return u16(block * 100 + 4 + 3 * k);
  }
  [[nodiscard]] std::uint8_t intensity(std::size_t block, std::size_t k) const
  {
    return bytes[block * 100 + 6 + 3 * k];
  }
  /** Microseconds after the full hour. */
  [[nodiscard]] std::uint32_t clock() const
  {
    return u16(1200) | (static_cast<std::uint32_t>(u16(1202)) << 16U);
  }
  [[nodiscard]] std::uint8_t returnMode() const { return bytes[1204]; }
  [[nodiscard]] std::uint8_t modelByte() const { return bytes[1205]; }

  static constexpr std::uint16_t upper_bank = 0xeeff;
  static constexpr std::uint16_t lower_bank = 0xddff;
  static constexpr std::uint8_t dual_return = 0x39;

 private:
  [[nodiscard]] std::uint16_t u16(std::size_t at) const
  {
    return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8U));
  }
};

/** Microseconds from one packet's clock to a later one's, over the turn of the hour. */
[[nodiscard]] double microsecondsBetween(std::uint32_t from, std::uint32_t to);

/** Ring of each laser: its rank by vertical angle, the lowest beam is 0. */
[[nodiscard]] std::vector<std::uint16_t> ringsOf(const mrpt::obs::VelodyneCalibration& calibration);

/** Seconds from one laser's shot to the next one's; 0 for models where it is not known. */
[[nodiscard]] double laserPeriod(std::size_t lasers);

/** Reads a maker's XML, or the YAML that ROS drivers use. \throws UserError if it is neither or is
 * not of `lasers` lasers. */
[[nodiscard]] mrpt::obs::VelodyneCalibration readVelodyneCalibration(const std::string& path,
                                                                     std::size_t lasers);

/** Turns packets of VLP-16 (16 lasers), HDL-32E (32) and HDL-64E (64) into points.
 *
 * MRPT's own CObservationVelodyneScan::generatePointCloud() reads only 16 of each block's 32
 * returns, so half of every scan would be lost. Geometry and firing times after the makers' user
 * manuals; the azimuth moves on within a block. HDL-64E firing times are evenly spread, which is
 * within 0.05 ms of the real pattern.
 */
class VelodyneDecoder
{
 public:
  /** \throws std::invalid_argument for calibrations of other than 16, 32 or 64 lasers. */
  VelodyneDecoder(const mrpt::obs::VelodyneCalibration& calibration,
                  double min_range,
                  double max_range);

  /** Appends a block's returns to the scan's points, intensity, time and ring.
   * \param time of the packet's first firing, in the scan's time [s].
   * \return false if the block's header is none of this model's. */
  bool decodeBlock(const VelodynePacketView& packet,
                   std::size_t block,
                   double time,
                   Scan& scan) const;

  [[nodiscard]] std::size_t lasers() const { return lasers_.size(); }

 private:
  struct Laser
  {
    double cos_elevation, sin_elevation, azimuth_correction, distance_correction, vertical_offset,
        horizontal_offset;
    std::uint16_t ring;
  };
  [[nodiscard]] double azimuthStep(const VelodynePacketView& packet, bool dual) const;
  [[nodiscard]] Eigen::Vector3f point(const Laser& laser, double range, double azimuth) const;

  std::vector<Laser> lasers_;
  double min_range_;
  double max_range_;
};
}  // namespace dyslam
