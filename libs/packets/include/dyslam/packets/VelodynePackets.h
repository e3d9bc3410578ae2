// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/packets/VelodyneModels.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace dyslam
{
constexpr std::size_t velodyne_packet_size = 1206;
constexpr std::size_t velodyne_blocks = 12;

/** View of a data packet: the parts that are the same for all models. */
struct VelodynePacketView
{
  const std::uint8_t* bytes = nullptr;  //!< velodyne_packet_size bytes

  [[nodiscard]] std::uint16_t header(std::size_t block) const { return u16(block * 100); }
  /** Azimuth of a block, clockwise from ahead [0.01 deg]. */
  [[nodiscard]] std::uint16_t azimuth(std::size_t block) const { return u16(block * 100 + 2); }
  [[nodiscard]] std::uint16_t range(std::size_t block, std::size_t k) const
  {
    return u16(block * 100 + 4 + 3 * k);
  }
  [[nodiscard]] std::uint8_t intensity(std::size_t block, std::size_t k) const
  {
    return bytes[block * 100 + 6 + 3 * k];
  }
  /** Time of the packet after the full hour [us]. */
  [[nodiscard]] std::uint32_t clock() const
  {
    return u16(1200) | (static_cast<std::uint32_t>(u16(1202)) << 16U);
  }
  [[nodiscard]] std::uint8_t returnMode() const { return bytes[1204]; }
  [[nodiscard]] std::uint8_t modelByte() const { return bytes[1205]; }

  /** Bank of 32 lasers of a block, by its header; 0: the first 32. Nothing if it has no data. */
  [[nodiscard]] std::optional<std::size_t> bank(std::size_t block) const
  {
    const std::uint16_t mark = header(block);
    return mark == 0xeeff   ? std::optional<std::size_t>(0)
           : mark == 0xddff ? std::optional<std::size_t>(1)
           : mark == 0xccff ? std::optional<std::size_t>(2)
           : mark == 0xbbff ? std::optional<std::size_t>(3)
                            : std::nullopt;
  }

  /** Whether a block is one of the empty blocks in packets of a VLS-128 with dual returns. */
  [[nodiscard]] bool isPadding(std::size_t block) const
  {
    return returnMode() == dual_return && block >= 8 &&
           (header(block) == 0 || header(block) == 0xffff);
  }

  static constexpr std::uint8_t dual_return = 0x39;

 private:
  [[nodiscard]] std::uint16_t u16(std::size_t at) const
  {
    return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8U));
  }
};

/** Time from one packet to a later one [us], with the overflow at the full hour. */
[[nodiscard]] double microsecondsBetween(std::uint32_t from, std::uint32_t to);

/** Turns packets into points.
 *
 * MRPT's own CObservationVelodyneScan::generatePointCloud() reads only 16 of each block's 32
 * returns, so half of every scan would be lost. Geometry and firing times after the makers' user
 * manuals; the azimuth moves on within a block.
 */
class VelodyneDecoder
{
 public:
  /** \throws std::invalid_argument for a calibration of another number of lasers than the model's.
   */
  VelodyneDecoder(VelodyneModel model,
                  const mrpt::obs::VelodyneCalibration& calibration,
                  double min_range,
                  double max_range);

  /** Time of a block's firing after the first one of its packet [s]. A sector that the lidar leaves
   * out between two blocks takes its part of the turn. */
  [[nodiscard]] double timeOf(const VelodynePacketView& packet, std::size_t block) const;
  /** Appends the returns of a block to the scan's points, intensity, time and ring.
   * \param time time of the packet's first firing after the scan's stamp [s]
   * \return false if the header of the block is not one of this model */
  bool decodeBlock(const VelodynePacketView& packet,
                   std::size_t block,
                   double time,
                   Scan& scan) const;

 private:
  struct Laser
  {
    double cos_elevation, sin_elevation, azimuth_correction, distance_correction, vertical_offset,
        horizontal_offset;
    std::uint16_t ring;
  };
  [[nodiscard]] bool isDual(const VelodynePacketView& packet) const;
  /** The block of which a block has the second returns; nothing if it has first ones. */
  [[nodiscard]] std::optional<std::size_t> firstReturnOf(std::size_t block, bool dual) const;
  [[nodiscard]] std::size_t blocksOfFiring(bool dual) const;
  [[nodiscard]] double blockTime() const;
  [[nodiscard]] double shotOffset(std::size_t laser, std::size_t place) const;
  [[nodiscard]] double azimuthStep(const VelodynePacketView& packet, bool dual) const;
  [[nodiscard]] Eigen::Vector3f point(const Laser& laser, double range, double azimuth) const;

  VelodyneModel model_;
  VelodyneTraits traits_;
  std::vector<Laser> lasers_;
  double min_range_;
  double max_range_;
};
}  // namespace dyslam
