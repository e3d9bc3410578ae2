// SPDX-License-Identifier: BSD-3-Clause
#include "CaptureDecoder.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/packets/HesaiScans.h>
#include <dyslam/packets/OusterScans.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "OusterBytes.h"

namespace dyslam
{
namespace
{
/** How well the metadata of a lidar fit one of its packets: those of the sensor's mode, then those
 * that state no other port, which tells lidars whose packets have no serial number. */
int fitOf(const OusterMetadata& metadata, const LidarPacket& packet)
{
  const bool has_mode = modeOfOuster(packet.bytes.data(), metadata) == OusterMode::same;
  const bool has_port = metadata.lidar_port == 0 || portOf(packet) == metadata.lidar_port;
  return 1 + (has_mode ? 2 : 0) + (has_port ? 1 : 0);
}

/** Chooses the decoder for the first packets of a capture. */
class DecoderChoice
{
 public:
  DecoderChoice(const PacketInput& input,
                const PacketSourceOptions& options,
                const std::deque<LidarPacket>& packets)
      : capture_(input.name()), has_files_(!input.isLive()), options_(options), packets_(packets)
  {
  }

  [[nodiscard]] CaptureDecoder best() const
  {
    const std::string& calibration = options_.calibration_file;
    if (lowerExtension(calibration) == ".json" || isOusterMetadata(calibration))
    {
      return ouster(calibration);
    }
    const bool is_automatic = options_.model == VelodyneModel::automatic;
    if (is_automatic && countOf(HesaiScans::isPacket) > countOf(VelodyneScans::isPacket))
    {
      return decoderOf(std::make_unique<HesaiScans>(capture_, hesaiOptions()));
    }
    // A stray datagram may have the size of a Velodyne's packets.
    if (calibration.empty() && is_automatic && has_files_ &&
        2 * countOf(VelodyneScans::isPacket) <= static_cast<std::ptrdiff_t>(packets_.size()))
    {
      if (CaptureDecoder found = ousterBeside(); found.scans != nullptr)
      {
        return found;
      }
    }
    return decoderOf(std::make_unique<VelodyneScans>(capture_, options_));
  }

 private:
  [[nodiscard]] static CaptureDecoder decoderOf(std::unique_ptr<PacketScans> scans)
  {
    CaptureDecoder decoder;
    decoder.scans = std::move(scans);
    return decoder;
  }

  [[nodiscard]] HesaiScansOptions hesaiOptions() const
  {
    HesaiScansOptions of_hesai;
    of_hesai.angle_file = options_.calibration_file;
    of_hesai.min_range = options_.min_range;
    of_hesai.cut_azimuth = options_.cut_azimuth;
    of_hesai.keep_partial = options_.keep_partial;
    return of_hesai;
  }

  [[nodiscard]] CaptureDecoder ouster(const std::string& file) const
  {
    const OusterMetadata metadata = parseOusterMetadata(readWhole(file), file);
    CaptureDecoder decoder =
        decoderOf(std::make_unique<OusterScans>(capture_, metadata, options_.keep_partial));
    decoder.metadata = file;
    decoder.ouster_packet_size = OusterScans::packetSize(metadata);
    decoder.lidar_port = metadata.lidar_port;
    decoder.imu_port = metadata.imu_port;
    decoder.T_vehicle_lidar = metadata.T_vehicle_sensor;
    for (const LidarPacket& packet : packets_)
    {
      if (decoder.scans->takes(packet))
      {
        decoder.fit = std::max(decoder.fit, fitOf(metadata, packet));
      }
    }
    return decoder;
  }

  /** With the metadata beside the capture: those that fit its packets best, or else the first, so
   * that messages name them; none if there are none. \throws UserError if all are damaged. */
  [[nodiscard]] CaptureDecoder ousterBeside() const
  {
    std::optional<UserError> damage;
    std::vector<CaptureDecoder> whole;
    for (const std::string& file : ousterMetadataBeside(capture_))
    {
      try
      {
        whole.push_back(ouster(file));
      }
      catch (const UserError& error)
      {
        damage = damage.value_or(error);
      }
    }
    if (whole.empty() && damage)
    {
      throw UserError(*damage);
    }
    const auto best = std::max_element(whole.begin(), whole.end(),
                                       [](const CaptureDecoder& a, const CaptureDecoder& b)
                                       { return a.fit < b.fit; });
    if (best == whole.end())
    {
      return {};
    }
    if (best->fit > 0)
    {
      best->notes.push_back("metadata of the lidar: " + best->metadata);
    }
    for (const CaptureDecoder& other : whole)
    {
      if (leaves(*best, other))
      {
        appendWord(best->other_metadata, other.metadata);
      }
    }
    return std::move(*best);
  }

  /** Whether there is a packet that is of the other's lidar and not of that of `chosen`. */
  [[nodiscard]] bool leaves(const CaptureDecoder& chosen, const CaptureDecoder& other) const
  {
    return std::any_of(packets_.begin(), packets_.end(),
                       [&](const LidarPacket& packet)
                       { return other.scans->takes(packet) && !chosen.scans->takes(packet); });
  }

  [[nodiscard]] std::ptrdiff_t countOf(bool (*kind)(const LidarPacket&)) const
  {
    return std::count_if(packets_.begin(), packets_.end(), kind);
  }

  const std::string& capture_;  //!< name of the input
  bool has_files_;              //!< files may lie beside the input
  const PacketSourceOptions& options_;
  const std::deque<LidarPacket>& packets_;
};
}  // namespace

CaptureDecoder chooseDecoder(const PacketInput& input,
                             const PacketSourceOptions& options,
                             const std::deque<LidarPacket>& packets)
{
  return DecoderChoice(input, options, packets).best();
}
}  // namespace dyslam
