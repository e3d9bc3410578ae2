// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/HesaiPackets.h>

#include <ctime>

namespace dyslam
{
namespace
{
constexpr std::size_t tail_with_sequence = 28;  //!< tail of PandarQT and PandarXT packets [bytes]
constexpr std::size_t crc_bytes = 4;
constexpr std::size_t safety_bytes = 17;
constexpr std::size_t sequence_bytes = 4;
constexpr std::size_t imu_bytes = 22;
constexpr std::size_t signature_bytes = 32;

/** Puts the bytes of return mode, speed, date and clock in their places. */
void setTail(HesaiLayout& layout,
             std::size_t tail,
             std::size_t return_mode,
             std::size_t speed,
             std::size_t date,
             std::size_t clock)
{
  layout.return_mode_at = tail + return_mode;
  layout.speed_at = tail + speed;
  layout.date_at = tail + date;
  layout.clock_at = tail + clock;
}

std::size_t bodyEnd(const HesaiLayout& layout)
{
  return layout.first_block + layout.blocks * layout.blockBytes();
}

/** Of Pandar40P and 64, which state the end of a firing and the azimuth there.
 * \param last_end end of the last one after the packet's time [s] */
void setEnds(HesaiLayout& layout, double last_end)
{
  layout.block_period = 55.56e-6;
  layout.stamps_last = true;
  layout.begins_after = last_end - layout.block_period;
  layout.azimuth_after = layout.block_period;
}

HesaiLayout pandar40()
{
  HesaiLayout layout;
  layout.name = "Pandar40P";
  layout.lasers = 40;
  layout.blocks = 10;
  layout.azimuth_at = 2;
  layout.return_bytes = 3;
  layout.range_unit = 0.004;
  setEnds(layout, -28.58e-6);
  setTail(layout, bodyEnd(layout), 14, 8, 16, 10);
  layout.packet_bytes = bodyEnd(layout) + 22;
  return layout;
}

/** Header of 8 bytes: EE FF, lasers, blocks, -, unit of range [mm], 2 reserved. */
HesaiLayout pandar64(const std::vector<std::uint8_t>& bytes)
{
  HesaiLayout layout = pandar40();
  layout.name = "Pandar64";
  layout.lasers = bytes[2];
  layout.blocks = bytes[3];
  layout.first_block = 8;
  layout.azimuth_at = 0;
  layout.range_unit = 0.001 * bytes[5];
  setEnds(layout, -42.58e-6);
  setTail(layout, bodyEnd(layout), 14, 8, 16, 10);
  layout.packet_bytes = bodyEnd(layout) + 22;
  return layout;
}

/** Lidars of the protocols 1.x and 3.2, whose packets have parts by the flags of their header.
 * \return where the tail begins */
std::size_t setOptionalParts(HesaiLayout& layout, unsigned flags)
{
  constexpr unsigned has_sequence = 1;
  constexpr unsigned has_imu = 2;
  constexpr unsigned has_safety = 4;
  constexpr unsigned has_signature = 8;
  const std::size_t tail =
      bodyEnd(layout) + crc_bytes + ((flags & has_safety) != 0 ? safety_bytes : 0);
  setTail(layout, tail, 12, 13, 15, 21);
  layout.packet_bytes = tail + 26 + ((flags & has_sequence) != 0 ? sequence_bytes : 0) +
                        ((flags & has_imu) != 0 ? imu_bytes : 0) + crc_bytes +
                        ((flags & has_signature) != 0 ? signature_bytes : 0);
  return tail;
}

/** Pandar128 and its relatives. The fifth byte tells the series; their models of 40 and 64 lasers
 * are not the Pandar40P and 64. */
void setPandar128(HesaiLayout& layout, const std::vector<std::uint8_t>& bytes)
{
  constexpr std::uint8_t first_ot = 128;
  constexpr std::uint8_t first_jt = 137;
  constexpr double resolution_period = 27.778e-6;  // at high resolution; twice that otherwise
  constexpr std::size_t operational_state = 11;    // position in the tail
  const unsigned flags = bytes[11];
  // Confidence, weight and ambient light of each return are bytes of their own.
  layout.return_bytes = 3 + (flags >> 4U & 1U) + (flags >> 5U & 1U) + (flags >> 6U & 1U);
  layout.stamps_last = true;
  const std::size_t tail = setOptionalParts(layout, flags);
  const std::string lasers = std::to_string(layout.lasers);
  if (bytes[4] >= first_jt)
  {
    layout.name = "JT" + lasers;
    layout.block_period = 111e-6;
    layout.begins_after = -1888e-6;
    return;
  }
  layout.name = bytes[4] >= first_ot   ? "OT" + lasers
                : layout.lasers == 128 ? "Pandar128"
                                       : "Pandar" + lasers + "E3X";
  layout.begins_after = bytes[4] >= first_ot ? 0 : 3.148e-6;
  const bool is_fine =
      tail + operational_state < bytes.size() && bytes[tail + operational_state] == 0;
  layout.block_period = (is_fine ? 1 : 2) * resolution_period;
}

/** Header of 12 bytes: EE FF, major and minor version, 2 reserved, lasers, blocks, first return,
 * unit of range [mm], returns, flags. */
std::optional<HesaiLayout> layoutOfProtocol(const std::vector<std::uint8_t>& bytes)
{
  constexpr unsigned has_confidence = 16;
  constexpr unsigned has_chosen_channels = 64;
  constexpr std::size_t mode_flag = 5;  // position in the tail
  const int protocol = 100 * bytes[2] + bytes[3];
  const unsigned flags = bytes[11];
  HesaiLayout layout;
  layout.first_block = 12;
  layout.lasers = bytes[6];
  layout.blocks = bytes[7];
  layout.return_bytes = 4;
  layout.range_unit = 0.001 * bytes[9];
  switch (protocol)
  {
    case 103:
    case 104:
      setPandar128(layout, bytes);
      return layout;
    case 301:
      layout.name = "QT" + std::to_string(layout.lasers);
      layout.block_period = 166.67e-6;
      layout.begins_after = 25.71e-6;
      setTail(layout, bodyEnd(layout), 16, 10, 18, 12);
      layout.packet_bytes = bodyEnd(layout) + tail_with_sequence;
      return layout;
    case 302:
      layout.name = "QT" + std::to_string(layout.lasers);
      layout.block_period = 111.11e-6;
      layout.begins_after = 9e-6;
      layout.sequence_at = setOptionalParts(layout, flags) + mode_flag;
      // Earlier firmware has the byte of the confidence, too, but not the flag.
      if ((flags & has_confidence) == 0 && bytes.size() < layout.packet_bytes)
      {
        layout.return_bytes = 3;
        layout.sequence_at = setOptionalParts(layout, flags) + mode_flag;
      }
      layout.has_chosen_channels = (flags & has_chosen_channels) != 0;
      return layout;
    case 601:
      layout.name = layout.lasers == 32 && layout.blocks == 6
                        ? "XT32M2X"
                        : "XT" + std::to_string(layout.lasers);
      layout.block_period = 50e-6;
      layout.stamps_last = true;
      layout.begins_after = 5.632e-6;
      setTail(layout, bodyEnd(layout), 10, 11, 13, 19);
      layout.packet_bytes = bodyEnd(layout) + tail_with_sequence;
      return layout;
    default:
      return std::nullopt;
  }
}
}  // namespace

std::optional<HesaiLayout> hesaiLayoutOf(const LidarPacket& packet)
{
  const std::vector<std::uint8_t>& bytes = packet.bytes;
  const auto startsWith = [&bytes](std::uint8_t first, std::uint8_t second)
  { return bytes.size() > 12 && bytes[0] == first && bytes[1] == second; };
  std::optional<HesaiLayout> layout;
  if (startsWith(0xff, 0xee))
  {
    layout = pandar40();
    // VLP packets begin alike, but have 100 bytes in each block.
    const std::size_t second_block = layout->blockBytes();
    const bool is_second = bytes.size() > second_block + 1 && bytes[second_block] == 0xff &&
                           bytes[second_block + 1] == 0xee;
    layout = is_second ? layout : std::nullopt;
  }
  else if (startsWith(0xee, 0xff))
  {
    layout = bytes[2] == 64 && bytes[3] == 6 ? pandar64(bytes) : layoutOfProtocol(bytes);
  }
  const bool fits = layout && layout->lasers > 0 && layout->blocks > 0 && layout->range_unit > 0 &&
                    bytes.size() >= layout->packet_bytes;
  return fits ? layout : std::nullopt;
}

std::optional<std::string> whyNoHesaiScans(const LidarPacket& packet)
{
  const std::vector<std::uint8_t>& bytes = packet.bytes;
  if (bytes.size() < 12 || bytes[0] != 0xee || bytes[1] != 0xff)
  {
    return std::nullopt;
  }
  const int protocol = 100 * bytes[2] + bytes[3];
  const char* const name = protocol == 108                      ? "JT16"
                           : protocol == 401 || protocol == 403 ? "AT128"
                           : protocol == 407                    ? "ATX"
                           : protocol == 702                    ? "FT120"
                                                                : nullptr;
  return name != nullptr ? std::optional("of a Hesai " + std::string(name) +
                                         ", which are not decoded; record the point cloud of its "
                                         "driver instead")
                         : std::nullopt;
}

std::size_t HesaiPacketView::returns() const
{
  constexpr std::uint8_t first_dual = 0x39;
  constexpr std::uint8_t triple = 0x3d;
  const std::uint8_t mode = bytes_[layout_.return_mode_at];
  return mode == triple ? 3 : mode >= first_dual ? 2 : 1;
}

double HesaiPacketView::time() const
{
  const std::uint8_t* date = bytes_ + layout_.date_at;
  const std::uint8_t* clock = bytes_ + layout_.clock_at;
  std::int64_t seconds = 0;
  if (date[0] == 0)  // seconds since 1970, the highest byte first
  {
    for (std::size_t i = 1; i < 6; ++i)
    {
      seconds = seconds * 256 + date[i];
    }
  }
  else
  {
    // Models and firmware count the years from 1900 or from 2000.
    const int year = date[0] < 100 ? 2000 + date[0] : 1900 + date[0];
    std::tm utc{};
    utc.tm_year = year - 1900;
    utc.tm_mon = date[1] - 1;
    utc.tm_mday = date[2];
    utc.tm_hour = date[3];
    utc.tm_min = date[4];
    utc.tm_sec = date[5];
    seconds = ::timegm(&utc);
  }
  const std::uint32_t microseconds = clock[0] | static_cast<std::uint32_t>(clock[1]) << 8U |
                                     static_cast<std::uint32_t>(clock[2]) << 16U |
                                     static_cast<std::uint32_t>(clock[3]) << 24U;
  return static_cast<double>(seconds) + 1e-6 * microseconds;
}
}  // namespace dyslam
