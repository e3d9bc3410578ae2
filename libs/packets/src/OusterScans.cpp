// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/packets/OusterImu.h>
#include <dyslam/packets/OusterScans.h>
#include <dyslam/packets/SensorClock.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "OusterBytes.h"

namespace dyslam
{
namespace
{
constexpr double seconds_per_nanosecond = 1e-9;
constexpr double ouster_range_unit = 1e-3;  //!< [m]
constexpr float full_reflectivity = 255;
constexpr int latest_frames = 8;  //!< packets of as many earlier frames are late ones

/** Positions and sizes in a data packet [bytes]. */
struct Layout
{
  std::size_t packet_header;
  std::size_t packet_footer;
  std::size_t column_header;
  std::size_t column;  //!< size of a column with its header and footer

  explicit Layout(const OusterMetadata& metadata)
  {
    const bool legacy = metadata.profile.isLegacy();
    packet_header = legacy ? 0 : ouster_header_size;
    packet_footer = legacy ? 0 : ouster_header_size;
    column_header = legacy ? 16 : 12;
    const std::size_t column_footer = legacy ? 4 : 0;
    column = column_header + metadata.beams() * metadata.profile.pixel_bytes + column_footer;
  }
};

/** Unit vectors along the beams with the encoder at 0. */
std::vector<Eigen::Vector3d> directionsOf(const OusterMetadata& metadata)
{
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t beam = 0; beam < metadata.beams(); ++beam)
  {
    const double azimuth = -metadata.azimuths[beam];
    const double altitude = metadata.altitudes[beam];
    directions.emplace_back(std::cos(azimuth) * std::cos(altitude),
                            std::sin(azimuth) * std::cos(altitude), std::sin(altitude));
  }
  return directions;
}

/** One firing of all beams. */
struct Column
{
  std::uint64_t time;    //!< time of the sensor's clock [ns]
  std::uint16_t number;  //!< number in the revolution, 0 at the connector
  bool valid;
  const std::uint8_t* pixels;
};

/** From a time of the sensor's clock to another [s]. */
double elapsed(std::uint64_t from, std::uint64_t to)
{
  return seconds_per_nanosecond * static_cast<double>(static_cast<std::int64_t>(to - from));
}

/** Packets may overtake each other: the stamp becomes that of the first firing. */
void startAtTheEarliest(Scan& scan)
{
  const float earliest = *std::min_element(scan.time.begin(), scan.time.end());
  if (earliest < 0)
  {
    scan.stamp += earliest;
    for (float& time : scan.time)
    {
      time -= earliest;
    }
  }
}
}  // namespace

struct OusterScans::Impl
{
  std::string place;
  OusterMetadata metadata;
  Layout layout;
  std::vector<std::uint16_t> rings;
  std::vector<Eigen::Vector3d> directions;
  RevolutionQueue queue;
  SensorClock clock;
  std::optional<std::uint64_t> last_time;  //!< last time of the sensor's clock [ns]
  double last_stamp = 0;                   //!< of that time, UNIX time [s]
  std::vector<ImuSample> imu;
  std::size_t imu_left_out = 0;  //!< number of samples

  Scan scan;                           //!< scan of the current frame
  std::optional<std::uint32_t> frame;  //!< number of the current frame
  std::vector<bool> received;          //!< whether each column of the frame was received
  bool begun = false;                  //!< a column of the frame was received, with returns or not
  std::size_t first_column = 0;
  std::size_t last_column = 0;
  std::size_t returns = 0;        //!< number of points of all frames
  std::size_t saturated = 0;      //!< number of points with an intensity above the scale
  std::size_t late = 0;           //!< number of packets of frames that were passed on before
  std::size_t repeated = 0;       //!< number of repeated columns
  std::size_t alien = 0;          //!< number of columns that no frame of this sensor has
  std::size_t of_other_mode = 0;  //!< number of packets of another mode than the metadata

  Impl(std::string place_in, const OusterMetadata& metadata_in, bool keep_partial)
      : place(std::move(place_in)),
        metadata(metadata_in),
        layout(metadata_in),
        rings(ringsByElevation(metadata_in.altitudes)),
        directions(directionsOf(metadata_in)),
        queue(keep_partial, inTurns(metadata_in.first_column), inTurns(metadata_in.last_column + 1))
  {
  }

  /** Angle from the connector to where a column begins [turns]. */
  [[nodiscard]] double inTurns(std::size_t column) const
  {
    return static_cast<double>(column) / static_cast<double>(metadata.columns);
  }

  [[nodiscard]] std::uint32_t frameOf(const std::uint8_t* packet) const
  {
    return metadata.profile.isLegacy() ? ousterNumberAt<std::uint16_t>(packet + 10)
           : metadata.fusa_header      ? ousterNumberAt<std::uint32_t>(packet + 4)
                                       : ousterNumberAt<std::uint16_t>(packet + 2);
  }

  /** \pre the packet has the size of a data packet */
  [[nodiscard]] bool isLidarPacket(const std::uint8_t* packet) const
  {
    return metadata.profile.isLegacy() ||
           (hasOusterType(packet, metadata, OusterPacketType::lidar) &&
            hasOusterSerial(packet, metadata));
  }

  [[nodiscard]] Column columnOf(const std::uint8_t* packet, std::size_t i) const
  {
    const std::uint8_t* at = packet + layout.packet_header + i * layout.column;
    const bool legacy = metadata.profile.isLegacy();
    Column column;
    column.time = ousterNumberAt<std::uint64_t>(at);
    column.number = ousterNumberAt<std::uint16_t>(at + 8);
    column.valid = legacy ? ousterNumberAt<std::uint32_t>(at + layout.column - 4) == 0xffffffffU
                          : (ousterNumberAt<std::uint16_t>(at + 10) & 1U) != 0;
    column.pixels = at + layout.column_header;
    return column;
  }

  /** \return false for a packet of a frame that was passed on, which comes too late. */
  bool beginFrame(std::uint32_t number)
  {
    if (frame == number)
    {
      return true;
    }
    if (frame)
    {
      const auto step = metadata.fusa_header
                            ? static_cast<std::int32_t>(number - *frame)
                            : static_cast<std::int16_t>(number - *frame);  // counted modulo 2^16
      if (step < 0 && step >= -latest_frames)
      {
        ++late;
        return false;
      }
    }
    finishFrame();
    frame = number;
    received.assign(metadata.columns, false);
    return true;
  }

  void finishFrame()
  {
    if (!scan.points.empty())
    {
      startAtTheEarliest(scan);
      scan.sensor_label = metadata.product;
      queue.push(std::move(scan), inTurns(first_column), inTurns(last_column + 1));
    }
    scan = Scan();
    begun = false;
    frame.reset();
  }

  void add(const LidarPacket& packet)
  {
    if (!beginFrame(frameOf(packet.bytes.data())))
    {
      return;
    }
    of_other_mode += modeOfOuster(packet.bytes.data(), metadata) == OusterMode::other ? 1 : 0;
    for (std::size_t i = 0; i < metadata.packet_columns; ++i)
    {
      const Column column = columnOf(packet.bytes.data(), i);
      if (!column.valid)
      {
        continue;
      }
      if (column.number >= metadata.columns)
      {
        ++alien;
        continue;
      }
      if (received[column.number])
      {
        ++repeated;
        continue;
      }
      received[column.number] = true;
      add(column, packet.captured);
    }
  }

  void add(const Column& column, double captured)
  {
    const double stamp = clock.advance(elapsed(last_time.value_or(0), column.time), captured);
    last_time = column.time;
    last_stamp = stamp;
    if (!begun)
    {
      begun = true;
      scan.stamp = stamp;
      first_column = column.number;
      last_column = column.number;
    }
    first_column = std::min<std::size_t>(first_column, column.number);
    last_column = std::max<std::size_t>(last_column, column.number);
    addPoints(column, static_cast<float>(stamp - scan.stamp));
  }

  void addPoints(const Column& column, float time)
  {
    const double encoder = -2 * M_PI * column.number / static_cast<double>(metadata.columns);
    Pose T_sensor_encoder = metadata.T_sensor_lidar;
    T_sensor_encoder.rotate(Eigen::AngleAxisd(encoder, Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d origin =
        T_sensor_encoder * Eigen::Vector3d(metadata.origin_outwards, 0, metadata.origin_up);
    // Ranges include the way from the axis to where the beams begin.
    const double before = std::hypot(metadata.origin_outwards, metadata.origin_up);
    for (std::size_t beam = 0; beam < metadata.beams(); ++beam)
    {
      const std::uint8_t* pixel = column.pixels + beam * metadata.profile.pixel_bytes;
      const Eigen::Vector3d direction = T_sensor_encoder.linear() * directions[beam];
      std::uint32_t earlier = 0;
      for (const OusterReturn& part : metadata.profile.returns)
      {
        const std::uint32_t range = rangeOf(pixel, part);
        if (range == 0 || range == earlier)
        {
          continue;
        }
        earlier = range;
        const double along = ouster_range_unit * range - before;
        scan.points.push_back((origin + along * direction).cast<float>());
        const float reflectivity = reflectivityOf(pixel, part);
        ++returns;
        saturated += reflectivity > 1 ? 1 : 0;
        scan.intensity.push_back(std::min(reflectivity, 1.0F));
        scan.time.push_back(time);
        scan.ring.push_back(rings[beam]);
      }
    }
  }

  void addImu(const OusterImuSample& sample)
  {
    constexpr double longest_step = 1;  // [s] from a lidar's column, on the same clock
    if (!last_time)
    {
      return;
    }
    const double step = elapsed(*last_time, sample.time);
    if (std::abs(step) > longest_step)
    {
      ++imu_left_out;
      return;
    }
    imu.push_back(
        {last_stamp + step, sample.angular_velocity, sample.acceleration, metadata.T_sensor_imu});
  }

  /** [mm], 0 without a return. */
  [[nodiscard]] static std::uint32_t rangeOf(const std::uint8_t* pixel, const OusterReturn& part)
  {
    const std::uint32_t bits = part.range_bytes == 2
                                   ? ousterNumberAt<std::uint16_t>(pixel + part.range_at)
                                   : ousterNumberAt<std::uint32_t>(pixel + part.range_at);
    return (bits & ((1U << part.range_bits) - 1)) * part.range_unit;
  }

  /** 0 to 1; more where firmware before 2.1 has 16 bits of an uncalibrated scale. */
  [[nodiscard]] float reflectivityOf(const std::uint8_t* pixel, const OusterReturn& part) const
  {
    const std::uint8_t* at = pixel + part.reflectivity_at;
    const std::uint16_t value =
        metadata.profile.isLegacy() ? ousterNumberAt<std::uint16_t>(at) : std::uint16_t{*at};
    return static_cast<float>(value) / full_reflectivity;
  }
};

OusterScans::OusterScans(std::string place, const OusterMetadata& metadata, bool keep_partial)
    : impl_(std::make_unique<Impl>(std::move(place), metadata, keep_partial))
{
}

OusterScans::~OusterScans() = default;

std::size_t OusterScans::packetSize(const OusterMetadata& metadata)
{
  const Layout layout(metadata);
  return layout.packet_header + metadata.packet_columns * layout.column + layout.packet_footer;
}

bool OusterScans::takes(const LidarPacket& packet) const
{
  // Early drivers for ROS recorded a byte more.
  const std::size_t size = packetSize(impl_->metadata);
  return (packet.bytes.size() == size || packet.bytes.size() == size + 1) &&
         impl_->isLidarPacket(packet.bytes.data());
}

void OusterScans::add(const LidarPacket& packet)
{
  impl_->add(packet);
}

void OusterScans::finish()
{
  impl_->finishFrame();
  impl_->queue.finish();
}

std::optional<Scan> OusterScans::take()
{
  return impl_->queue.take();
}

bool OusterScans::takesImu(const LidarPacket& packet) const
{
  return isOusterImuPacket(packet.bytes, impl_->metadata);
}

void OusterScans::addImu(const LidarPacket& packet)
{
  for (const OusterImuSample& sample : decodeOusterImu(packet.bytes))
  {
    impl_->addImu(sample);
  }
}

std::vector<ImuSample> OusterScans::takeImu()
{
  return std::exchange(impl_->imu, {});
}

std::string OusterScans::sensor() const
{
  return impl_->metadata.product;
}

std::vector<std::string> OusterScans::warnings() const
{
  std::vector<std::string> lines;
  if (impl_->late > 0)
  {
    lines.push_back(impl_->place + ": " + counted(impl_->late, "packet") +
                    " of an earlier frame left out, which came too late");
  }
  if (impl_->repeated > 0)
  {
    lines.push_back(impl_->place + ": " + counted(impl_->repeated, "column") +
                    " received twice, as if each packet was captured on two interfaces; used once");
  }
  if (impl_->saturated > impl_->returns / 100)
  {
    lines.push_back(impl_->place +
                    ": intensities are not calibrated (firmware before 2.1) and limited to 1");
  }
  if (impl_->alien > 0)
  {
    lines.push_back(impl_->place + ": " + counted(impl_->alien, "column") +
                    " left out, whose numbers do not fit the metadata");
  }
  if (impl_->of_other_mode > 0)
  {
    lines.push_back(impl_->place + ": " + counted(impl_->of_other_mode, "packet") +
                    (impl_->metadata.profile.isLegacy()
                         ? " with another number of columns in a revolution than the metadata "
                           "state: their points are wrong"
                         : " of another initialization of the sensor than the metadata: their "
                           "points are wrong if its mode was changed in between") +
                    "; give the metadata of this recording");
  }
  if (impl_->imu_left_out > 0)
  {
    lines.push_back(impl_->place + ": " + counted(impl_->imu_left_out, "sample") +
                    " of the IMU left out, more than 1 s from the times of the lidar's packets");
  }
  return lines;
}
}  // namespace dyslam
