// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Quantile.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/io/PcapSource.h>
#include <pcap/pcap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <filesystem>

#include "VelodynePackets.h"

namespace dyslam
{
namespace
{
constexpr std::size_t probe_packets = 64;  //!< looked at to find the model
constexpr double clock_jump = 1.0;         //!< [s] most between packets of a running clock
constexpr int whole_turn_tolerance = 300;  //!< [0.01 deg]

struct CapturedPacket
{
  std::array<std::uint8_t, velodyne_packet_size> bytes{};
  double captured = 0;  //!< UNIX time [s]

  [[nodiscard]] VelodynePacketView view() const { return {bytes.data()}; }
};

std::uint16_t bigEndian(const std::uint8_t* at)
{
  return static_cast<std::uint16_t>((at[0] << 8U) | at[1]);
}

/** Bytes before the IP header; VLAN tags are not counted. */
std::size_t headerSize(int link)
{
  switch (link)
  {
    case DLT_EN10MB:
      return 14;
    case DLT_LINUX_SLL:
      return 16;
    case DLT_LINUX_SLL2:  // of tcpdump -i any
      return 20;
    case DLT_NULL:
      return 4;
    default:
      return 0;
  }
}

struct UdpPacket
{
  const std::uint8_t* data = nullptr;  //!< null: none
  std::size_t size = 0;
  std::uint64_t stream = 0;  //!< sender's address and receiver's port: one of each lidar
};

/** The UDP packet in a captured frame. */
UdpPacket udpPacket(int link, const std::uint8_t* data, std::size_t size)
{
  std::size_t at = headerSize(link);
  if (link == DLT_EN10MB && size > 18 && bigEndian(data + 12) == 0x8100)
  {
    at += 4;
  }
  if (size < at + 28 || (data[at] >> 4U) != 4 || data[at + 9] != 17)
  {
    return {};
  }
  std::uint64_t stream = 0;
  for (std::size_t i = 12; i < 16; ++i)
  {
    stream = stream << 8U | data[at + i];
  }
  at += static_cast<std::size_t>(data[at] & 0x0fU) * 4;
  if (size < at + 8)
  {
    return {};
  }
  return {data + at + 8, std::min<std::size_t>(size - at - 8, bigEndian(data + at + 4) - 8U),
          stream << 16U | bigEndian(data + at + 2)};
}

/** Data packets of a capture file one by one, those of its first lidar. */
class PacketReader
{
 public:
  explicit PacketReader(const std::string& path) : path_(path)
  {
    (void)openBinary(path);
    size_ = std::filesystem::file_size(path);
    std::array<char, PCAP_ERRBUF_SIZE> message{};
    file_ = pcap_open_offline(path.c_str(), message.data());
    if (file_ == nullptr)
    {
      throw UserError(path + ": is not a network capture: " + message.data() +
                      "; give a folder, .pcap, .bag, .db3 or .mcap");
    }
  }
  ~PacketReader() { pcap_close(file_); }
  PacketReader(const PacketReader&) = delete;
  PacketReader& operator=(const PacketReader&) = delete;

  /** False at the end; `damage` then tells whether the file is damaged. */
  [[nodiscard]] bool next(CapturedPacket& packet)
  {
    pcap_pkthdr* header = nullptr;
    const u_char* data = nullptr;
    int code = 0;
    while ((code = pcap_next_ex(file_, &header, &data)) == 1)
    {
      const UdpPacket udp = udpPacket(pcap_datalink(file_), data, header->caplen);
      if (udp.data != nullptr && udp.size == velodyne_packet_size)
      {
        stream_ = stream_.value_or(udp.stream);
        if (udp.stream != *stream_)
        {
          ++of_others_;
          continue;
        }
        std::memcpy(packet.bytes.data(), udp.data, udp.size);
        packet.captured =
            static_cast<double>(header->ts.tv_sec) + 1e-6 * static_cast<double>(header->ts.tv_usec);
        ++count_;
        return true;
      }
    }
    if (code == PCAP_ERROR)
    {
      damage_ = pcap_geterr(file_);
    }
    return false;
  }

  [[nodiscard]] const std::string& damage() const { return damage_; }
  [[nodiscard]] std::size_t count() const { return count_; }
  /** Data packets of other lidars than the first. */
  [[nodiscard]] std::size_t ofOthers() const { return of_others_; }
  [[nodiscard]] double progress() const
  {
    const long at = std::ftell(pcap_file(file_));
    return at < 0 || size_ == 0 ? 1.0 : static_cast<double>(at) / static_cast<double>(size_);
  }

 private:
  std::string path_;
  pcap_t* file_ = nullptr;
  std::uintmax_t size_ = 0;
  std::size_t count_ = 0;
  std::size_t of_others_ = 0;
  std::optional<std::uint64_t> stream_;  //!< of the first data packet
  std::string damage_;
};

/** A revolution while it is read, with the data that show whether it is complete. */
struct Revolution
{
  Scan scan;
  bool begun = false;
  int first_azimuth = 0;  //!< after the cut [0.01 deg]
  int last_azimuth = 0;
};

std::string nameOf(VelodyneModel model)
{
  return model == VelodyneModel::vlp16    ? "VLP16"
         : model == VelodyneModel::hdl32e ? "HDL32E"
         : model == VelodyneModel::hdl64e ? "HDL64E"
                                          : "auto";
}
}  // namespace

void PcapSourceOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice("model", model,
                 {{"auto", VelodyneModel::automatic},
                  {"VLP16", VelodyneModel::vlp16},
                  {"HDL32E", VelodyneModel::hdl32e},
                  {"HDL64E", VelodyneModel::hdl64e}},
                 "model of the lidar; auto: from the packets");
  visitor.text("calibration_file", calibration_file,
               "Velodyne XML or YAML calibration file; empty: the model's default");
  visitor.real("min_range", min_range, 0, 100,
               "range below which returns (own vehicle) are dropped [m]");
  visitor.degrees("cut_azimuth_deg", cut_azimuth, 0, 360,
                  "azimuth at which scans are cut, clockwise from straight ahead [deg]");
  visitor.flag("keep_partial", keep_partial, "deliver also incomplete first and last revolutions");
}

struct PcapSource::Impl
{
  std::string path;
  PcapSourceOptions options;
  PacketReader reader;
  VelodyneModel model = VelodyneModel::automatic;
  std::unique_ptr<VelodyneDecoder> decoder;
  std::deque<CapturedPacket> probed;
  std::vector<std::string> notes;
  int cut = 18000;

  Revolution current;
  std::deque<Revolution> ready;
  std::optional<int> typical_first;  //!< azimuths where whole revolutions begin and end
  std::optional<int> typical_last;
  bool first_revolution = true;
  bool finished = false;
  std::size_t bad_blocks = 0;
  double stamp_offset = 0;  //!< capture's clock minus the sensor's unrolled one
  double sensor_time = 0;   //!< unrolled [s]
  std::optional<std::uint32_t> last_clock;
  double last_captured = 0;  //!< UNIX time [s]

  Impl(const std::string& path_in, const PcapSourceOptions& options_in)
      : path(path_in), options(options_in), reader(path_in)
  {
    cut = static_cast<int>(std::lround(options.cut_azimuth * 18000 / M_PI)) % 36000;
    CapturedPacket packet;
    while (probed.size() < probe_packets && reader.next(packet))
    {
      probed.push_back(packet);
    }
    if (probed.empty())
    {
      throw UserError(path + ": has no Velodyne data packets (UDP, 1206 bytes)" +
                      (reader.damage().empty() ? "" : "; " + reader.damage()));
    }
    model = options.model == VelodyneModel::automatic ? guessModel() : options.model;
    decoder = std::make_unique<VelodyneDecoder>(calibration(), options.min_range, 250.0);
  }

  /** By the blocks' headers and the packets' pace: some firmware gives the wrong model byte. */
  VelodyneModel guessModel()
  {
    for (const CapturedPacket& packet : probed)
    {
      if (packet.view().header(1) == VelodynePacketView::lower_bank ||
          packet.view().header(0) == VelodynePacketView::lower_bank)
      {
        return VelodyneModel::hdl64e;
      }
    }
    const std::uint8_t byte = probed.front().view().modelByte();
    const char* other = byte == 0x24   ? "Puck Hi-Res"
                        : byte == 0x28 ? "VLP-32C"
                        : byte == 0xA1 ? "VLS-128"
                                       : nullptr;
    if (other != nullptr)
    {
      throw UserError(path + ": is of a " + other + ", which is not decoded" +
                      (byte == 0x24 ? "; with --sensor VLP16 and its --calibration it is"
                                    : "; record the clouds of its driver in a ROS bag"));
    }
    VelodyneModel stated = byte == 0x21   ? VelodyneModel::hdl32e
                           : byte == 0x22 ? VelodyneModel::vlp16
                                          : VelodyneModel::automatic;
    std::vector<double> paces;
    for (std::size_t i = 1; i < probed.size(); ++i)
    {
      paces.push_back(microsecondsBetween(probed[i - 1].view().clock(), probed[i].view().clock()));
    }
    if (!paces.empty())
    {
      const bool dual = probed.front().view().returnMode() == VelodynePacketView::dual_return;
      const double pace = upperMedian(paces) * (dual ? 2 : 1);
      // 1327 us for VLP-16, 553 us for HDL-32E.
      const auto paced = pace > 1200 && pace < 1450 ? VelodyneModel::vlp16
                         : pace > 480 && pace < 630 ? VelodyneModel::hdl32e
                                                    : stated;
      if (stated != paced)
      {
        notes.push_back(path + ": taken as " + nameOf(paced) + " by the pace of its packets" +
                        (stated == VelodyneModel::automatic
                             ? ""
                             : ", not as the " + nameOf(stated) + " that they claim to be"));
        stated = paced;
      }
    }
    if (stated == VelodyneModel::automatic)
    {
      throw UserError(path + ": unknown lidar (model byte " + std::to_string(byte) +
                      "); name VLP16, HDL32E or HDL64E");
    }
    return stated;
  }

  [[nodiscard]] mrpt::obs::VelodyneCalibration calibration() const
  {
    const std::size_t lasers = model == VelodyneModel::vlp16    ? 16
                               : model == VelodyneModel::hdl32e ? 32
                                                                : 64;
    const std::string& file = options.calibration_file;
    if (file.empty() && lasers == 64)
    {
      // Every HDL-64E differs, and MRPT's common calibration of it cannot be loaded in 2.5.8.
      throw UserError(path + ": an HDL64E needs its own calibration; name it with --calibration");
    }
    return file.empty() ? mrpt::obs::VelodyneCalibration::LoadDefaultCalibration(
                              lasers == 16 ? "VLP16" : "HDL32")
                        : readVelodyneCalibration(file, lasers);
  }

  [[nodiscard]] bool nextPacket(CapturedPacket& packet)
  {
    if (!probed.empty())
    {
      packet = probed.front();
      probed.pop_front();
      return true;
    }
    return reader.next(packet);
  }

  /** The sensor's clock unrolled over hours and set to the time of the first packet's capture.
   * Where it goes back or jumps, it was set, or packets are missing: the time that passed is that
   * of the capture's clock. */
  double stampOf(const CapturedPacket& packet)
  {
    const std::uint32_t clock = packet.view().clock();
    if (last_clock)
    {
      const double step = 1e-6 * microsecondsBetween(*last_clock, clock);
      const double captured_step = packet.captured - last_captured;
      sensor_time += step;
      if ((step < 0 || step > clock_jump) && std::abs(captured_step - step) > clock_jump)
      {
        stamp_offset += captured_step - step;
      }
    }
    else
    {
      stamp_offset = packet.captured;
    }
    last_clock = clock;
    last_captured = packet.captured;
    return sensor_time + stamp_offset;
  }

  void add(const CapturedPacket& packet)
  {
    const double stamp = stampOf(packet);
    const VelodynePacketView view = packet.view();
    for (std::size_t block = 0; block < velodyne_blocks; ++block)
    {
      const int azimuth = (view.azimuth(block) + 36000 - cut) % 36000;
      if (current.last_azimuth - azimuth > 18000)
      {
        finishRevolution();
      }
      if (!current.begun)
      {
        current.begun = true;
        current.scan.stamp = stamp;
        current.first_azimuth = azimuth;
      }
      current.last_azimuth = azimuth;
      if (!decoder->decodeBlock(view, block, stamp - current.scan.stamp, current.scan))
      {
        ++bad_blocks;
      }
    }
  }

  void finishRevolution()
  {
    Revolution done = std::exchange(current, Revolution{});
    if (!first_revolution && !typical_first)
    {
      typical_first = done.first_azimuth;
    }
    if (done.begun)
    {
      ready.push_back(std::move(done));
    }
    first_revolution = false;
  }

  [[nodiscard]] static bool near(int a, int b) { return std::abs(a - b) <= whole_turn_tolerance; }

  /** Whether to deliver a revolution: all but an incomplete first and last one. */
  [[nodiscard]] bool whole(const Revolution& revolution, bool first, bool last) const
  {
    if (options.keep_partial)
    {
      return true;
    }
    const bool begins = !first || near(revolution.first_azimuth, typical_first.value_or(0));
    const bool ends = !last || near(revolution.last_azimuth, typical_last.value_or(35999));
    return begins && ends;
  }

  std::size_t taken = 0;

  std::optional<Scan> next()
  {
    CapturedPacket packet;
    // One revolution is held back, so that the last is known as such.
    while (ready.size() < 2 && !finished)
    {
      if (nextPacket(packet))
      {
        add(packet);
        continue;
      }
      finished = true;
      finishRevolution();
    }
    while (!ready.empty())
    {
      Revolution revolution = std::move(ready.front());
      ready.pop_front();
      const bool last = finished && ready.empty();
      const bool deliver = whole(revolution, taken == 0, last);
      if (taken++ > 0 && !last)
      {
        typical_last = revolution.last_azimuth;
      }
      if (deliver)
      {
        revolution.scan.sensor_label = nameOf(model);
        return std::move(revolution.scan);
      }
      if (ready.size() < 2 && !finished)
      {
        return next();
      }
    }
    if (!reader.damage().empty())
    {
      throw UserError(path + ": is cut short or damaged after " + std::to_string(reader.count()) +
                      " packets: " + reader.damage());
    }
    return std::nullopt;
  }
};

PcapSource::PcapSource(const std::string& path, const PcapSourceOptions& options)
{
  validate(options, "pcap source");
  impl_ = std::make_unique<Impl>(path, options);
}

PcapSource::~PcapSource() = default;
PcapSource::PcapSource(PcapSource&&) noexcept = default;
PcapSource& PcapSource::operator=(PcapSource&&) noexcept = default;

std::optional<Scan> PcapSource::next()
{
  return impl_->next();
}
VelodyneModel PcapSource::model() const
{
  return impl_->model;
}
double PcapSource::progress() const
{
  return impl_->reader.progress();
}

std::vector<std::string> PcapSource::warnings() const
{
  auto lines = impl_->notes;
  if (impl_->reader.ofOthers() > 0)
  {
    lines.push_back(impl_->path + ": " + std::to_string(impl_->reader.ofOthers()) +
                    " packets of other senders or ports left out; capture each lidar by itself");
  }
  if (impl_->bad_blocks > 0)
  {
    lines.push_back(impl_->path + ": " + std::to_string(impl_->bad_blocks) +
                    " blocks are not of a " + nameOf(impl_->model) + " and were ignored");
  }
  return lines;
}
}  // namespace dyslam
