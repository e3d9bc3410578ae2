// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/packets/HesaiPackets.h>
#include <dyslam/packets/HesaiScans.h>
#include <dyslam/packets/SensorClock.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double least_range = 0.05;           // [m]; below are codes of the sensor, no ranges
constexpr double azimuth_unit = M_PI / 18000;  // [rad]

/** Direction of a laser. */
struct Laser
{
  double cos_elevation;
  double sin_elevation;
  double azimuth;  //!< relative to the azimuth of the block [rad]
  std::uint16_t ring;
};
}  // namespace

struct HesaiScans::Impl
{
  std::string place;
  HesaiScansOptions options;
  std::optional<HesaiLayout> layout;  //!< layout of the first packet
  std::vector<Laser> lasers;
  std::array<std::vector<double>, 2> shots;  //!< of both firing sequences, after its begin [s]
  RevolutionCutter revolutions;
  SensorClock clock;
  std::optional<double> last_time;  //!< last time of the sensor's clock [s]

  Impl(std::string place_in, const HesaiScansOptions& options_in)
      : place(std::move(place_in)),
        options(options_in),
        revolutions(options_in.cut_azimuth, options_in.keep_partial)
  {
  }

  void start(const LidarPacket& packet)
  {
    layout = hesaiLayoutOf(packet);
    shots = {hesaiShots(*layout, false), hesaiShots(*layout, true)};
    const HesaiAngles angles = anglesOfLidar();
    const auto rings = ringsByElevation(angles.elevations);
    for (std::size_t i = 0; i < layout->lasers; ++i)
    {
      const double elevation = angles.elevations[i];
      lasers.push_back({std::cos(elevation), std::sin(elevation), angles.azimuths[i], rings[i]});
    }
  }

  [[nodiscard]] HesaiAngles anglesOfLidar() const
  {
    if (layout->has_chosen_channels)
    {
      throw UserError(place + ": this Hesai sends selected channels only, and its packets do not " +
                      "tell which; record with all channels (web page of the lidar)");
    }
    if (!options.angle_file.empty())
    {
      return readHesaiAngles(options.angle_file, layout->lasers);
    }
    if (auto designed = designedHesaiAngles(*layout))
    {
      return *designed;
    }
    throw UserError(place + ": a Hesai " + layout->name +
                    " needs its own angle correction file (.csv); name it with " +
                    options.calibration_flag);
  }

  void decode(const LidarPacket& packet)
  {
    const HesaiPacketView view(packet, *layout);
    const double time = view.time();
    const double stamp = clock.advance(time - last_time.value_or(0), packet.captured);
    last_time = time;
    const std::size_t returns = view.returns();
    for (std::size_t block = 0; block < layout->blocks; ++block)
    {
      const std::size_t firing = block / returns;
      const double periods = layout->stamps_last
                                 ? -static_cast<double>((layout->blocks - 1 - block) / returns)
                                 : static_cast<double>(firing);
      decodeBlock(view, block, block - block % returns,
                  stamp + layout->begins_after + layout->block_period * periods,
                  shots[view.isSecondSequence(firing) ? 1 : 0]);
    }
  }

  /** \param first block of the same firing. \param time of its begin, UNIX time [s]
   * \param shots_of_block times of the shots after that [s] */
  void decodeBlock(const HesaiPacketView& view,
                   std::size_t block,
                   std::size_t first,
                   double time,
                   const std::vector<double>& shots_of_block)
  {
    const int block_azimuth = view.azimuth(block);
    Scan& scan = revolutions.scanOf(block_azimuth, time);
    const double speed = revolutions.isClockwise() ? view.speed() : -view.speed();
    const double since_begin = time - scan.stamp;
    for (std::size_t i = 0; i < layout->lasers; ++i)
    {
      const std::uint16_t raw = view.range(block, i);
      const double range = raw * layout->range_unit;
      if (range < std::max(least_range, options.min_range) || repeats(view, block, first, i))
      {
        continue;
      }
      const Laser& laser = lasers[i];
      const double shot = shots_of_block[i];
      // The rotor turns on between the shots of a firing.
      const double turned = speed * (shot - layout->azimuth_after);
      const double azimuth = azimuth_unit * block_azimuth + laser.azimuth + turned;
      const double flat = range * laser.cos_elevation;
      scan.points.push_back(Eigen::Vector3d(flat * std::sin(azimuth), flat * std::cos(azimuth),
                                            range * laser.sin_elevation)
                                .cast<float>());
      scan.intensity.push_back(static_cast<float>(view.reflectivity(block, i)) / 255.0F);
      scan.time.push_back(static_cast<float>(since_begin + shot));
      scan.ring.push_back(laser.ring);
    }
  }

  /** Whether an earlier block of the firing has the same return. */
  [[nodiscard]] static bool repeats(const HesaiPacketView& view,
                                    std::size_t block,
                                    std::size_t first,
                                    std::size_t laser)
  {
    for (std::size_t other = first; other < block; ++other)
    {
      if (view.range(other, laser) == view.range(block, laser))
      {
        return true;
      }
    }
    return false;
  }
};

HesaiScans::HesaiScans(std::string place, const HesaiScansOptions& options)
    : impl_(std::make_unique<Impl>(std::move(place), options))
{
}

HesaiScans::~HesaiScans() = default;

bool HesaiScans::isPacket(const LidarPacket& packet)
{
  return hesaiLayoutOf(packet).has_value();
}

bool HesaiScans::takes(const LidarPacket& packet) const
{
  const auto layout = hesaiLayoutOf(packet);
  return layout && (!impl_->layout || (layout->name == impl_->layout->name &&
                                       layout->packet_bytes == impl_->layout->packet_bytes));
}

void HesaiScans::add(const LidarPacket& packet)
{
  if (!impl_->layout)
  {
    impl_->start(packet);
  }
  impl_->decode(packet);
}

void HesaiScans::finish()
{
  impl_->revolutions.finish();
}

std::optional<Scan> HesaiScans::take()
{
  auto scan = impl_->revolutions.take();
  if (scan)
  {
    scan->sensor_label = sensor();
  }
  return scan;
}

std::vector<std::string> HesaiScans::warnings() const
{
  const bool designed = impl_->layout && impl_->options.angle_file.empty();
  return designed
             ? std::vector<std::string>{impl_->place + ": angles are those that a " + sensor() +
                                        " is designed for; " + impl_->options.calibration_flag +
                                        " names the angle correction file of this one (.csv)"}
             : std::vector<std::string>();
}

std::string HesaiScans::sensor() const
{
  return impl_->layout ? impl_->layout->name : "Hesai";
}
}  // namespace dyslam
