// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/packets/SensorClock.h>
#include <dyslam/packets/VelodynePackets.h>
#include <dyslam/packets/VelodyneScans.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t model_probe = 64;  //!< packets that are looked at to find the model
constexpr double max_range = 300;        //!< [m], beyond the reach of every model

std::string nameOf(VelodyneModel model)
{
  return model == VelodyneModel::automatic ? "auto" : traitsOf(model).name;
}

VelodynePacketView viewOf(const LidarPacket& packet)
{
  return {packet.bytes.data()};
}
}  // namespace

struct VelodyneScans::Impl
{
  std::string place;
  VelodyneScansOptions options;
  VelodyneModel model = VelodyneModel::automatic;
  std::unique_ptr<VelodyneDecoder> decoder;  //!< none until the model is known
  std::vector<LidarPacket> probed;           //!< packets that wait for the decoder
  std::vector<std::string> notes;
  RevolutionCutter revolutions;
  std::size_t bad_blocks = 0;
  SensorClock clock;
  std::optional<std::uint32_t> last_clock;

  Impl(std::string place_in, const VelodyneScansOptions& options_in)
      : place(std::move(place_in)),
        options(options_in),
        revolutions(options_in.cut_azimuth, options_in.keep_partial)
  {
  }

  /** Decides on the model, and decodes the packets that waited for that. */
  void start()
  {
    model = options.model == VelodyneModel::automatic ? guessModel() : options.model;
    decoder = std::make_unique<VelodyneDecoder>(model, calibration(), options.min_range, max_range);
    for (const LidarPacket& packet : probed)
    {
      decode(packet);
    }
    probed.clear();
  }

  /** By the packets' model byte, but by their rate where that says otherwise: some firmware gives
   * the wrong byte. HDL-64E, whose byte is something else, and VLS-128 have further banks of
   * lasers.
   */
  VelodyneModel guessModel()
  {
    const std::uint8_t byte = viewOf(probed.front()).modelByte();
    const auto stated = velodyneModelOf(byte);
    const std::size_t bank = highestBank();
    if (bank > 0)
    {
      return bank == 1 ? VelodyneModel::hdl64e : VelodyneModel::vls128;
    }
    const auto by_rate = modelByRate();
    const bool fits = by_rate && stated &&
                      traitsOf(*stated).firing_time == traitsOf(*by_rate).firing_time &&
                      traitsOf(*stated).lasers == traitsOf(*by_rate).lasers;
    if (!by_rate && !stated)
    {
      throw UserError(place + ": unknown lidar (model byte " + std::to_string(byte) +
                      "); name it with --sensor: " + velodyneModelNames());
    }
    if (!by_rate || fits)
    {
      return *stated;
    }
    notes.push_back(place + ": taken as " + nameOf(*by_rate) + " by the rate of its packets" +
                    (stated ? ", not as the " + nameOf(*stated) + " that they claim to be" : ""));
    return *by_rate;
  }

  [[nodiscard]] std::size_t highestBank() const
  {
    std::size_t highest = 0;
    for (const LidarPacket& packet : probed)
    {
      for (std::size_t block = 0; block < velodyne_blocks; ++block)
      {
        highest = std::max(highest, viewOf(packet).bank(block).value_or(0));
      }
    }
    return highest;
  }

  /** The model that sends a packet every 1327 us (VLP-16), 553 us (HDL-32E) or 664 us (VLP-32C), or
   * nothing. */
  [[nodiscard]] std::optional<VelodyneModel> modelByRate() const
  {
    std::vector<double> periods;
    for (std::size_t i = 1; i < probed.size(); ++i)
    {
      periods.push_back(
          microsecondsBetween(viewOf(probed[i - 1]).clock(), viewOf(probed[i]).clock()));
    }
    if (periods.empty())
    {
      return std::nullopt;
    }
    const bool dual = viewOf(probed.front()).returnMode() == VelodynePacketView::dual_return;
    const double period = upperMedian(periods) * (dual ? 2 : 1);
    return period > 1200 && period < 1450 ? std::optional(VelodyneModel::vlp16)
           : period > 480 && period < 600 ? std::optional(VelodyneModel::hdl32e)
           : period > 620 && period < 720 ? std::optional(VelodyneModel::vlp32c)
                                          : std::nullopt;
  }

  [[nodiscard]] mrpt::obs::VelodyneCalibration calibration() const
  {
    const std::string& file = options.calibration_file;
    if (file.empty() && model == VelodyneModel::hdl64e)
    {
      throw UserError(place + ": an HDL64E needs its own calibration; name it with " +
                      options.calibration_flag);
    }
    return file.empty() ? usualCalibration(model)
                        : readVelodyneCalibration(file, traitsOf(model).lasers);
  }

  void decode(const LidarPacket& packet)
  {
    const VelodynePacketView view = viewOf(packet);
    const double step =
        last_clock ? 1e-6 * microsecondsBetween(*last_clock, view.clock()) : 0;  // since the hour
    last_clock = view.clock();
    const double stamp = clock.advance(step, packet.captured);
    for (std::size_t block = 0; block < velodyne_blocks; ++block)
    {
      if (view.isPadding(block))
      {
        continue;
      }
      if (!view.bank(block))
      {
        ++bad_blocks;
        continue;
      }
      Scan& scan = revolutions.scanOf(view.azimuth(block), stamp + decoder->timeOf(view, block));
      if (!decoder->decodeBlock(view, block, stamp - scan.stamp, scan))
      {
        ++bad_blocks;
      }
    }
  }
};

VelodyneScans::VelodyneScans(std::string place, const VelodyneScansOptions& options)
    : impl_(std::make_unique<Impl>(std::move(place), options))
{
}

VelodyneScans::~VelodyneScans() = default;

bool VelodyneScans::isPacket(const LidarPacket& packet)
{
  return packet.bytes.size() == velodyne_packet_size;
}

void VelodyneScans::add(const LidarPacket& packet)
{
  if (impl_->decoder != nullptr)
  {
    impl_->decode(packet);
    return;
  }
  impl_->probed.push_back(packet);
  if (impl_->probed.size() == model_probe)
  {
    impl_->start();
  }
}

void VelodyneScans::finish()
{
  if (impl_->decoder == nullptr && !impl_->probed.empty())
  {
    impl_->start();
  }
  impl_->revolutions.finish();
}

std::optional<Scan> VelodyneScans::take()
{
  auto scan = impl_->revolutions.take();
  if (scan)
  {
    scan->sensor_label = sensor();
  }
  return scan;
}

std::string VelodyneScans::sensor() const
{
  return nameOf(impl_->model);
}

VelodyneModel VelodyneScans::model() const
{
  return impl_->model;
}

std::vector<std::string> VelodyneScans::warnings() const
{
  auto lines = impl_->notes;
  if (impl_->bad_blocks > 0)
  {
    lines.push_back(impl_->place + ": " + std::to_string(impl_->bad_blocks) +
                    " blocks are not of a " + sensor() + " and were ignored");
  }
  return lines;
}
}  // namespace dyslam
