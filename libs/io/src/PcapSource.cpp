// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Quantile.h>
#include <dyslam/io/PcapSource.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "VelodyneCapture.h"
#include "VelodynePackets.h"

namespace dyslam
{
namespace
{
constexpr std::size_t probe_packets = 64;  //!< looked at to find the model
constexpr double clock_jump = 1.0;         //!< longest step between packets of a running clock [s]
constexpr double max_range = 250;          //!< [m], beyond the reach of every model
constexpr int turn = 36000;                //!< [0.01 deg], as all azimuths here
constexpr int whole_turn_tolerance = 300;  //!< [0.01 deg]
constexpr std::uint8_t hdl32e_byte = 0x21;
constexpr std::uint8_t vlp16_byte = 0x22;

/** A revolution while it is read, with the data that show whether it is complete. */
struct Revolution
{
  Scan scan;
  bool begun = false;
  int first_azimuth = 0;  //!< from the cut on [0.01 deg]
  int last_azimuth = 0;   //!< from the cut on [0.01 deg]
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
  VelodyneCapture reader;
  VelodyneModel model = VelodyneModel::automatic;
  std::unique_ptr<VelodyneDecoder> decoder;
  std::deque<CapturedPacket> probed;
  std::vector<std::string> notes;
  int cut = turn / 2;  //!< azimuth where scans are cut [0.01 deg]

  Revolution current;
  std::deque<Revolution> ready;
  std::optional<int> typical_first;  //!< azimuths where whole revolutions begin and end
  std::optional<int> typical_last;
  bool first_revolution = true;
  bool finished = false;
  std::size_t bad_blocks = 0;
  std::size_t taken = 0;    //!< revolutions out of `ready`, delivered or not
  double stamp_offset = 0;  //!< capture's clock minus the sensor's unrolled one [s]
  double sensor_time = 0;   //!< unrolled [s]
  std::optional<std::uint32_t> last_clock;
  double last_captured = 0;  //!< UNIX time [s]

  Impl(const std::string& path_in, const PcapSourceOptions& options_in)
      : path(path_in), options(options_in), reader(path_in)
  {
    cut = static_cast<int>(std::lround(options.cut_azimuth * 18000 / M_PI)) % turn;
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
    decoder = std::make_unique<VelodyneDecoder>(calibration(), options.min_range, max_range);
  }

  /** By the blocks' headers and the packets' rate: some firmware gives the wrong model byte. */
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
    requireDecodable(byte);
    const VelodyneModel stated = byte == hdl32e_byte  ? VelodyneModel::hdl32e
                                 : byte == vlp16_byte ? VelodyneModel::vlp16
                                                      : VelodyneModel::automatic;
    const VelodyneModel model_by_rate = modelByRate().value_or(stated);
    if (model_by_rate == VelodyneModel::automatic)
    {
      throw UserError(path + ": unknown lidar (model byte " + std::to_string(byte) +
                      "); name VLP16, HDL32E or HDL64E");
    }
    if (stated != model_by_rate)
    {
      notes.push_back(path + ": taken as " + nameOf(model_by_rate) + " by the rate of its packets" +
                      (stated == VelodyneModel::automatic
                           ? ""
                           : ", not as the " + nameOf(stated) + " that they claim to be"));
    }
    return model_by_rate;
  }

  /** \throws UserError for the model byte of a lidar that VelodyneDecoder does not support. */
  void requireDecodable(std::uint8_t byte) const
  {
    constexpr std::uint8_t hi_res = 0x24;  // a VLP-16 with other beam angles
    const char* other = byte == hi_res ? "Puck Hi-Res"
                        : byte == 0x28 ? "VLP-32C"
                        : byte == 0xA1 ? "VLS-128"
                                       : nullptr;
    if (other != nullptr)
    {
      throw UserError(path + ": is of a " + other + ", which is not decoded" +
                      (byte == hi_res ? "; with --sensor VLP16 and its --calibration it is"
                                      : "; record the clouds of its driver in a ROS bag"));
    }
  }

  /** The model that sends a packet every 1327 us (VLP-16) or 553 us (HDL-32E), or nothing. */
  [[nodiscard]] std::optional<VelodyneModel> modelByRate() const
  {
    std::vector<double> periods;
    for (std::size_t i = 1; i < probed.size(); ++i)
    {
      periods.push_back(
          microsecondsBetween(probed[i - 1].view().clock(), probed[i].view().clock()));
    }
    if (periods.empty())
    {
      return std::nullopt;
    }
    const bool dual = probed.front().view().returnMode() == VelodynePacketView::dual_return;
    const double period = upperMedian(periods) * (dual ? 2 : 1);
    return period > 1200 && period < 1450 ? std::optional(VelodyneModel::vlp16)
           : period > 480 && period < 630 ? std::optional(VelodyneModel::hdl32e)
                                          : std::nullopt;
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

  /** The stamp of a packet [s]: the sensor's clock, unrolled over hours and set to the time of the
   * first packet's capture. Where it goes back or jumps, it was set, or packets are missing: the
   * time that passed is that of the capture's clock. */
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
      const int azimuth = (view.azimuth(block) + turn - cut) % turn;
      if (current.last_azimuth - azimuth > turn / 2)
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
    const bool ends = !last || near(revolution.last_azimuth, typical_last.value_or(turn - 1));
    return begins && ends;
  }

  /** Reads on until two revolutions are ready: one is held back, so that the last is known as
   * such. */
  void fillReady()
  {
    CapturedPacket packet;
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
  }

  std::optional<Scan> next()
  {
    for (fillReady(); !ready.empty(); fillReady())
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
