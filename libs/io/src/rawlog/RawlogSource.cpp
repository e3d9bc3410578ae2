// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogStream.h>
#include <dyslam/io/ScanDecoder.h>

#include <deque>
#include <utility>

namespace dyslam
{
void RawlogSourceOptions::describe(OptionsVisitor& visitor)
{
  visitor.text("sensor_label", sensor_label,
               "regex for the lidar's sensor label; empty: the first lidar");
  visitor.text("further_lidars", further_lidars,
               "regex for the sensor labels of further lidars of the vehicle, whose scans are "
               "merged with those of the first; empty: none");
  describeRange(visitor);
  visitor.text("ground_truth_label", ground_truth_label,
               "sensor label of the true poses; empty: use none");
  visitor.real("ground_truth_max_gap", ground_truth_max_gap, 0, 10,
               "largest time between true poses that are interpolated [s]");
  visitor.flag("external_anywhere", external_anywhere,
               "also read external files outside the recording's folder");
  visitor.real("intensity_scale", intensity_scale, 0, 1000,
               "factor on the file's intensities; 0: 1, or 1/255 for 0..255 data");
  visitor.text("imu_label", imu_label,
               "regex for the IMU's sensor label; empty: the first with a gyroscope");
  visitor.text("odometry_label", odometry_label,
               "regex for the wheel odometry's sensor label; empty: the first");
  visitor.text("gnss_label", gnss_label,
               "regex for the satellite receiver's sensor label; empty: the first");
  visitor.flag(
      "level", level,
      "set roll_deg and pitch_deg so that the ground of the first scans is level, if it is "
      "inclined by 4 deg or more in the recording's vehicle frame");
  visitor.degrees(
      "roll_deg", roll, -180, 180,
      "roll of the recording's vehicle over level ground: scans are rotated by it about x [deg]");
  visitor.degrees("pitch_deg", pitch, -90, 90,
                  "pitch of the recording's vehicle over level ground: scans are rotated by it "
                  "about y, after the roll [deg]");
}

struct RawlogSource::Impl
{
  Impl(const std::string& path, const RawlogSourceOptions& options, std::function<bool()> stop)
      : limit(static_cast<std::size_t>(options.only_first_n)),
        stream(path, std::move(stop)),
        decoder(options, path, stream.externalFolder())
  {
    readOn([this] { return pending.empty() && !decoder.isPastEnd(); });
    if (!pending.empty())
    {
      return;
    }
    if (postponed)
    {
      throw UserError(*postponed);
    }
    if (stream.isStopped())
    {
      throw UserError(path + ": stopped before its first scan");
    }
    decoder.failWithoutScans(stream.leftOut());
  }

  /** Reads wanted scans with good time stamps up to the end or an error, which is kept in
   * `postponed`. */
  template <typename NeedsMore>
  void readOn(const NeedsMore& needsMore)
  {
    try
    {
      while (!postponed && !ended && needsMore())
      {
        const auto observation = stream.next();
        ended = observation == nullptr;
        if (auto scan = ended ? std::nullopt : decoder.take(observation))
        {
          pending.push_back(std::move(*scan));
        }
      }
    }
    catch (const UserError& error)
    {
      postponed = error;
    }
  }

  std::optional<Frame> next()
  {
    if (limit != 0 && delivered >= limit)
    {
      return std::nullopt;
    }
    if (pending.empty())
    {
      if (postponed)
      {
        throw UserError(*postponed);
      }
      return std::nullopt;
    }
    // The next scan is looked up first: truth may stand behind its scan.
    readOn(
        [this]
        {
          return (pending.size() < 2 && !decoder.isPastEnd()) ||
                 decoder.waitsForFurther(pending.front());
        });
    const RecordedScan current = std::move(pending.front());
    pending.pop_front();
    Frame frame = decoder.decode(current);
    frame.T_world_vehicle_truth = decoder.truthAt(frame.scan.stamp, current.clock_shift);
    ++delivered;
    return frame;
  }

  std::size_t limit;  //!< 0: none
  RawlogStream stream;
  ScanDecoder decoder;
  std::deque<RecordedScan> pending;    //!< to be delivered next
  std::optional<UserError> postponed;  //!< found while looking ahead
  bool ended = false;                  //!< all observations were read
  std::size_t delivered = 0;
};

RawlogSource::RawlogSource(const std::string& path,
                           const RawlogSourceOptions& options,
                           std::function<bool()> stop)
{
  validate(options, "input");
  impl_ = std::make_unique<Impl>(path, options, std::move(stop));
}

RawlogSource::~RawlogSource() = default;
RawlogSource::RawlogSource(RawlogSource&&) noexcept = default;
RawlogSource& RawlogSource::operator=(RawlogSource&&) noexcept = default;

std::optional<Frame> RawlogSource::next()
{
  return impl_->next();
}
bool RawlogSource::isStopped() const
{
  return impl_->stream.isStopped();
}
double RawlogSource::progress() const
{
  return impl_->decoder.progress(impl_->stream.progress(), impl_->delivered);
}
std::size_t RawlogSource::framesRead() const
{
  return impl_->delivered;
}
std::size_t RawlogSource::framesDropped() const
{
  return impl_->decoder.framesDropped();
}
std::string RawlogSource::sensorLabel() const
{
  return impl_->decoder.sensorLabel();
}
std::vector<std::string> RawlogSource::warnings() const
{
  auto lines = impl_->decoder.warnings();
  const auto of_file = impl_->stream.warnings();
  lines.insert(lines.end(), of_file.begin(), of_file.end());
  return lines;
}
}  // namespace dyslam
