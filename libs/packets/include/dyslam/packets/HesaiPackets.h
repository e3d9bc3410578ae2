// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/LidarPacket.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Layout of the data packets of a spinning Hesai lidar, after the maker's user manuals. Positions
 * are bytes from the beginning of the packet. */
struct HesaiLayout
{
  std::string name;  //!< name of the model: "XT32"
  std::size_t lasers = 0;
  std::size_t blocks = 0;
  std::size_t first_block = 0;
  std::size_t azimuth_at = 0;    //!< position of the azimuth in a block [bytes]
  std::size_t return_bytes = 0;  //!< of each laser in a block: range (2), reflectivity (1), others
  double range_unit = 0;         //!< unit of ranges [m]
  std::size_t return_mode_at = 0;
  std::size_t date_at = 0;
  std::size_t clock_at = 0;
  std::size_t speed_at = 0;                //!< position of the motor's speed [rpm]
  std::optional<std::size_t> sequence_at;  //!< of the flag which firing sequence is the first
  bool has_chosen_channels = false;        //!< only those that the user selected on the lidar
  double block_period = 0;                 //!< time from one firing of all lasers to the next [s]
  bool stamps_last = false;  //!< the packet's time is that of its last firing, not of its first
  double begins_after = 0;   //!< time from the packet's to the begin of that firing [s]
  double azimuth_after = 0;  //!< time from the begin of a firing to the block's azimuth [s]
  std::size_t packet_bytes = 0;

  [[nodiscard]] std::size_t blockBytes() const { return azimuth_at + 2 + lasers * return_bytes; }
};

/** By the header, or of a Pandar40P, which has none, by the size; nothing for packets of other
 * sensors and of Hesai's that are not decoded (AT128, FT120, JT16). */
[[nodiscard]] std::optional<HesaiLayout> hesaiLayoutOf(const LidarPacket& packet);
/** What to say of the packets of a Hesai that are not decoded, such as an AT128's; nothing for all
 * others. */
[[nodiscard]] std::optional<std::string> whyNoHesaiScans(const LidarPacket& packet);

/** One data packet. \pre the packet outlives the view, and `layout` is its own */
class HesaiPacketView
{
 public:
  HesaiPacketView(const LidarPacket& packet, const HesaiLayout& layout)
      : bytes_(packet.bytes.data()), layout_(layout)
  {
  }

  /** Azimuth of a block, clockwise [0.01 deg], 0 to 35999. */
  [[nodiscard]] int azimuth(std::size_t block) const
  {
    return u16(blockAt(block) + layout_.azimuth_at) % 36000;
  }
  /** Range of a return in units of the layout; 0: no return. */
  [[nodiscard]] std::uint16_t range(std::size_t block, std::size_t laser) const
  {
    return u16(returnAt(block, laser));
  }
  [[nodiscard]] std::uint8_t reflectivity(std::size_t block, std::size_t laser) const
  {
    return bytes_[returnAt(block, laser) + 2];
  }
  /** Speed of the motor, in either direction [rad/s]. */
  [[nodiscard]] double speed() const { return u16(layout_.speed_at) * (2 * M_PI / 60); }
  /** Whether a firing is of the second sequence of a lidar that has two. \param firing number in
   * the packet, from 0 */
  [[nodiscard]] bool isSecondSequence(std::size_t firing) const
  {
    return layout_.sequence_at && (bytes_[*layout_.sequence_at] + firing) % 2 == 0;
  }
  /** Number of blocks per firing: 1, or 2 or 3 with several returns. */
  [[nodiscard]] std::size_t returns() const;
  /** Time by the sensor's clock [s]: UNIX time if the clock is set, else with any origin. */
  [[nodiscard]] double time() const;

 private:
  [[nodiscard]] std::uint16_t u16(std::size_t at) const
  {
    return static_cast<std::uint16_t>(bytes_[at] | (bytes_[at + 1] << 8U));
  }
  [[nodiscard]] std::size_t blockAt(std::size_t block) const
  {
    return layout_.first_block + block * layout_.blockBytes();
  }
  [[nodiscard]] std::size_t returnAt(std::size_t block, std::size_t laser) const
  {
    return blockAt(block) + layout_.azimuth_at + 2 + laser * layout_.return_bytes;
  }

  const std::uint8_t* bytes_;
  const HesaiLayout& layout_;
};

/** Directions of the lasers [rad]. */
struct HesaiAngles
{
  std::vector<double> elevations;
  std::vector<double> azimuths;  //!< clockwise, relative to the azimuth of the block
};

/** Times of the lasers' shots after the begin of a firing [s], after the maker's user manuals;
 * zeros for models whose shots are not known. \param second of the second firing sequence */
[[nodiscard]] std::vector<double> hesaiShots(const HesaiLayout& layout, bool second);

/** Nominal angles of a model; nothing for models whose lidars all differ. */
[[nodiscard]] std::optional<HesaiAngles> designedHesaiAngles(const HesaiLayout& layout);
/** Reads the maker's angle correction file of a lidar (.csv: channel, elevation, azimuth).
 * \throws UserError if it is none, or not of `lasers` lasers. */
[[nodiscard]] HesaiAngles readHesaiAngles(const std::string& path, std::size_t lasers);
}  // namespace dyslam
