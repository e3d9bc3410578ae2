// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/core/Pose.h>
#include <dyslam/packets/HesaiPackets.h>
#include <dyslam/packets/HesaiScans.h>
#include <dyslam/packets/PacketSource.h>

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

#include "CaptureDecoder.h"

namespace dyslam
{
namespace
{
constexpr std::size_t probe_packets = 256;  //!< number of packets examined to find the maker

/** Size and port of the most frequent datagrams. */
std::pair<std::size_t, std::uint64_t> mostFrequent(const std::deque<LidarPacket>& packets)
{
  std::map<std::pair<std::size_t, std::uint64_t>, std::size_t> counts;
  std::pair<std::size_t, std::uint64_t> most;
  for (const LidarPacket& packet : packets)
  {
    const std::pair kind(packet.bytes.size(), portOf(packet));
    if (++counts[kind] > counts[most])
    {
      most = kind;
    }
  }
  return most;
}
}  // namespace

void PacketSourceOptions::describe(OptionsVisitor& visitor)
{
  describeVelodyneModel(visitor, "model", model, "model of a Velodyne; auto: from the packets");
  visitor.text("calibration_file", calibration_file,
               "Velodyne's XML or YAML calibration or Hesai's angle correction (.csv), empty: the "
               "model's default; or the metadata of an Ouster (.json), empty: those beside the "
               "capture");
  visitor.real("min_range", min_range, 0, 100,
               "range below which a Velodyne's or Hesai's returns (own vehicle) are dropped [m]");
  visitor.degrees("cut_azimuth_deg", cut_azimuth, 0, 360,
                  "azimuth at which a Velodyne's or Hesai's scans are cut, clockwise from its "
                  "azimuth 0 [deg]");
  visitor.flag("imu", imu, "keep the samples of the IMU in an Ouster");
  visitor.flag("keep_partial", keep_partial, "deliver also incomplete first and last revolutions");
}

struct PacketSource::Impl
{
  std::unique_ptr<PacketInput> input;
  std::string path;  //!< name of the input
  PacketSourceOptions options;
  std::deque<LidarPacket> probed;
  CaptureDecoder decoder;
  std::optional<std::uint64_t> stream;       //!< stream of the lidar's packets
  bool has_imu_port = false;                 //!< packets of the IMU have the port that is stated
  std::size_t taken = 0;                     //!< number of packets of the lidar
  std::size_t imu_packets = 0;               //!< number of packets of the IMU in the lidar
  std::vector<std::uint8_t> last_bytes;      //!< last packet of the lidar
  std::vector<std::uint8_t> last_imu_bytes;  //!< last packet of the IMU in it
  std::size_t repeated = 0;   //!< number of packets that were the same as the one before
  std::size_t of_others = 0;  //!< number of packets of other lidars
  bool finished = false;
  std::optional<Scan> first;
  std::string probed_kind;      //!< the most frequent packets, for messages; empty: there are none
  std::size_t probed_size = 0;  //!< size of the most frequent packets [bytes]
  std::optional<std::string> not_decoded;  //!< what to say of packets that are known only

  Impl(std::unique_ptr<PacketInput> input_in, const PacketSourceOptions& options_in)
      : input(std::move(input_in)), path(input->name()), options(options_in)
  {
    LidarPacket packet;
    while (probed.size() < probe_packets && input->next(packet))
    {
      not_decoded = not_decoded ? not_decoded : whyNoHesaiScans(packet);
      probed.push_back(std::move(packet));
    }
    if (!probed.empty())
    {
      const auto [size, port] = mostFrequent(probed);
      probed_size = size;
      probed_kind = std::to_string(size) + " bytes (port " + std::to_string(port) + ")";
    }
    decoder = chooseDecoder(*input, options, probed);
    readPorts();
    if (!decoder.T_vehicle_lidar.matrix().isIdentity(1e-6))
    {
      decoder.notes.push_back(
          "the metadata place the lidar on its vehicle, which is done by --sensor-pose '" +
          poseText(decoder.T_vehicle_lidar) + "'");
    }
    // A live input need not end: whose packets they are must show in the first ones.
    if (!input->isLive() || isAnyTaken())
    {
      first = read();
    }
    if (taken == 0)
    {
      throw UserError(whyNone());
    }
  }

  /** Finds the packets of an Ouster by the ports that its metadata state, where others are alike:
   * those of several lidars that ouster-cli saved have the same sender. */
  void readPorts()
  {
    for (const LidarPacket& packet : probed)
    {
      if (!stream && portOf(packet) == decoder.lidar_port && decoder.scans->takes(packet))
      {
        stream = packet.stream;
      }
    }
    has_imu_port = std::any_of(
        probed.begin(), probed.end(),
        [this](const LidarPacket& packet)
        { return portOf(packet) == decoder.imu_port && decoder.scans->takesImu(packet); });
  }

  /** Whether one of the first packets is of the lidar. */
  [[nodiscard]] bool isAnyTaken() const
  {
    return std::any_of(probed.begin(), probed.end(),
                       [this](const LidarPacket& packet) { return decoder.scans->takes(packet); });
  }

  [[nodiscard]] std::string whyNone() const
  {
    std::string damage = input->damage().empty() ? "" : "; " + input->damage();
    for (const std::string& reason : input->reasonsForNone())
    {
      damage += "; " + reason;
    }
    const std::string has = probed_kind.empty() ? "" : ", but UDP packets of " + probed_kind;
    if (!decoder.metadata.empty())
    {
      return path + ": has no data packets of the lidar of " + decoder.metadata + " (UDP, " +
             std::to_string(decoder.ouster_packet_size) + " bytes)" + has +
             (probed_size == decoder.ouster_packet_size ? " of a sensor with another serial number"
                                                        : "") +
             damage;
    }
    if (not_decoded)
    {
      return path + ": has UDP packets " + *not_decoded + damage;
    }
    return path + ": has no data packets of a Velodyne (UDP, 1206 bytes) or a Hesai" + has +
           damage +
           (has.empty() ? ""
            : input->isLive()
                ? "; of an Ouster, name its metadata (.json) with --calibration"
                : "; of an Ouster, put its metadata (.json) beside the capture or name them "
                  "with --calibration");
  }

  [[nodiscard]] bool nextPacket(LidarPacket& packet)
  {
    if (probed.empty())
    {
      return input->next(packet);
    }
    packet = std::move(probed.front());
    probed.pop_front();
    return true;
  }

  /** The next scan, nothing at the end of the input. */
  [[nodiscard]] std::optional<Scan> read()
  {
    LidarPacket packet;
    for (;;)
    {
      if (auto scan = decoder.scans->take())
      {
        return scan;
      }
      if (finished)
      {
        return std::nullopt;
      }
      if (nextPacket(packet))
      {
        add(packet);
        continue;
      }
      finished = true;
      decoder.scans->finish();
    }
  }

  /** Whether a packet was sent by the IMU in the lidar. */
  [[nodiscard]] bool isOfImu(const LidarPacket& packet) const
  {
    return stream && packet.stream >> port_bits == *stream >> port_bits &&
           (!has_imu_port || portOf(packet) == decoder.imu_port) && decoder.scans->takesImu(packet);
  }

  /** Counts a packet of the IMU in the lidar, and decodes it if the options ask for that. */
  void addImu(const LidarPacket& packet)
  {
    if (packet.bytes == last_imu_bytes)
    {
      return;  // captured twice, as warned of the packets of the lidar
    }
    last_imu_bytes = packet.bytes;
    ++imu_packets;
    if (options.imu)
    {
      decoder.scans->addImu(packet);
    }
  }

  void add(const LidarPacket& packet)
  {
    if (!decoder.scans->takes(packet))
    {
      if (isOfImu(packet))
      {
        addImu(packet);
        return;
      }
      const bool of_lidar = VelodyneScans::isPacket(packet) || HesaiScans::isPacket(packet) ||
                            packet.bytes.size() == decoder.ouster_packet_size;
      of_others += of_lidar ? 1 : 0;
      return;
    }
    stream = stream.value_or(packet.stream);
    if (packet.stream != *stream)
    {
      ++of_others;
      return;
    }
    if (packet.bytes == last_bytes)
    {
      ++repeated;
      return;
    }
    last_bytes = packet.bytes;
    ++taken;
    decoder.scans->add(packet);
  }
};

PacketSource::PacketSource(std::unique_ptr<PacketInput> input, const PacketSourceOptions& options)
{
  validate(options, "packet source");
  impl_ = std::make_unique<Impl>(std::move(input), options);
}

PacketSource::~PacketSource() = default;
PacketSource::PacketSource(PacketSource&&) noexcept = default;
PacketSource& PacketSource::operator=(PacketSource&&) noexcept = default;

std::optional<Scan> PacketSource::next()
{
  auto scan = impl_->first ? std::exchange(impl_->first, std::nullopt) : impl_->read();
  if (!scan && !impl_->input->damage().empty())
  {
    throw UserError(impl_->path + ": is cut short or damaged after " +
                    counted(impl_->taken, "packet") + ": " + impl_->input->damage());
  }
  return scan;
}

const std::string& PacketSource::name() const
{
  return impl_->path;
}

bool PacketSource::readsImu() const
{
  return impl_->decoder.scans->readsImu();
}

std::size_t PacketSource::imuPackets() const
{
  return impl_->imu_packets;
}

std::vector<ImuSample> PacketSource::takeImu()
{
  return impl_->decoder.scans->takeImu();
}

std::string PacketSource::sensor() const
{
  return impl_->decoder.scans->sensor();
}

double PacketSource::progress() const
{
  return impl_->input->progress();
}

const std::vector<std::string>& PacketSource::notes() const
{
  return impl_->decoder.notes;
}

std::vector<std::string> PacketSource::warnings() const
{
  auto lines = impl_->decoder.scans->warnings();
  if (impl_->repeated > 0)
  {
    lines.push_back(impl_->path + ": " + counted(impl_->repeated, "packet") +
                    " received twice, as if captured on two interfaces; used once");
  }
  for (const std::string& warning : impl_->input->warnings())
  {
    lines.push_back(impl_->path + ": " + warning);
  }
  if (!impl_->decoder.other_metadata.empty())
  {
    lines.push_back(impl_->path +
                    ": has packets of other lidars, too; --calibration with their "
                    "metadata reads them: " +
                    impl_->decoder.other_metadata);
  }
  else if (impl_->of_others > 0)
  {
    lines.push_back(impl_->path + ": " + std::to_string(impl_->of_others) +
                    " packets of other senders or ports left out; " +
                    impl_->input->adviceForSeveral());
  }
  return lines;
}
}  // namespace dyslam
