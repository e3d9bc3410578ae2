// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/io/RawlogSource.h>
#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/registerAllClasses.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <regex>
#include <utility>

#include "IntensityScaler.h"
#include "MrptConversions.h"
#include "ObservationScans.h"
#include "RawlogStream.h"

namespace dyslam
{
namespace
{
using mrpt::obs::CObservation;

constexpr std::size_t max_dropped_in_a_row = 10;
constexpr double same_time = 1e-6;    //!< stamps this near are one [s]
constexpr double truth_memory = 2.0;  //!< how long old true poses are kept [s]

bool endsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::regex compiled(const std::string& pattern)
{
  try
  {
    return std::regex(pattern);
  }
  catch (const std::regex_error&)
  {
    throw UserError("sensor_label = " + pattern + " is not a regular expression");
  }
}
}  // namespace

void RawlogSourceOptions::describe(OptionsVisitor& visitor)
{
  visitor.text("sensor_label", sensor_label, "regex for the lidar's label; empty: the first lidar");
  visitor.integer("skip_first_n", skip_first_n, 0, 1000000000, "scans to skip");
  visitor.integer("only_first_n", only_first_n, 0, 1000000000, "scans to deliver; 0: all");
  visitor.text("ground_truth_label", ground_truth_label, "of the true poses; empty: use none");
  visitor.real("ground_truth_max_gap", ground_truth_max_gap, 0, 10,
               "true poses this near in time are interpolated [s]");
  visitor.real("intensity_scale", intensity_scale, 0, 1000,
               "multiplies the file's intensities; 0: 1, or 1/255 for 0..255 data");
}

struct RawlogSource::Impl
{
  RawlogSourceOptions options;
  RawlogStream stream;
  std::regex wanted;
  IntensityScaler scale_intensity;
  std::string label;  //!< of the lidar in use, once it is known

  /** A scan not yet decoded, its times and rings if it has them, and its number in the file. */
  struct Numbered
  {
    CObservation::Ptr observation;
    CObservation::Ptr companion;
    std::size_t index = 0;
  };
  Numbered pending;             //!< the scan to be delivered next; null at the end
  CObservation::Ptr companion;  //!< read, its scan not yet
  std::deque<StampedPose> truths;
  std::optional<UserError> postponed;  //!< found while looking ahead

  std::size_t scans_seen = 0;  //!< with the wanted label, delivered or not
  std::optional<double> last_stamp;
  std::size_t dropped = 0;
  std::size_t dropped_in_a_row = 0;
  std::size_t delivered = 0;

  std::map<std::string, std::size_t> seen_classes;
  std::map<std::string, std::size_t> lidar_labels;
  struct Note
  {
    std::string text;
    std::size_t times = 0;
    std::size_t first_scan = 0;
    bool tells_scan = true;
  };
  std::vector<Note> notes;

  Impl(const std::string& path, const RawlogSourceOptions& options_in)
      : options(options_in),
        stream(path),
        wanted(compiled(options_in.sensor_label)),
        scale_intensity(options_in.intensity_scale)
  {
    pending = nextScan();
    if (!pending.observation)
    {
      fail();
    }
  }

  /** \param at_scan adds the number of the scan at hand. */
  void warn(const std::string& text, bool at_scan = true)
  {
    const auto it = std::find_if(notes.begin(), notes.end(),
                                 [&text](const Note& note) { return note.text == text; });
    if (it == notes.end())
    {
      notes.push_back({text, 1, scans_seen - std::min<std::size_t>(scans_seen, 1), at_scan});
    }
    else
    {
      ++it->times;
    }
  }

  /** Why there is not a single scan. */
  [[noreturn]] void fail()
  {
    if (postponed)
    {
      throw UserError(*postponed);
    }
    if (scans_seen > 0)
    {
      throw UserError(stream.path() + ": skip_first_n = " + std::to_string(options.skip_first_n) +
                      " leaves no scan; the file has " + std::to_string(scans_seen));
    }
    if (!lidar_labels.empty())
    {
      std::string known;
      for (const auto& [name, count] : lidar_labels)
      {
        known += (known.empty() ? "'" : ", '") + name + "'";
      }
      throw UserError(stream.path() + ": no 3D scan has a label like '" + options.sensor_label +
                      "'; the file has " + known);
    }
    std::string held;
    for (const auto& [name, count] : seen_classes)
    {
      held += (held.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    }
    const bool flat = seen_classes.count("CObservation2DRangeScan") > 0;
    throw UserError(stream.path() + ": has no 3D scans" + (held.empty() ? "" : ", only " + held) +
                    (flat ? "; 2D scans cannot be used" : "") + "; give a recording of a 3D LiDAR");
  }

  [[nodiscard]] bool isWanted(const CObservation& observation)
  {
    const std::string& name = observation.sensorLabel;
    ++lidar_labels[name];
    if (!options.sensor_label.empty() && !std::regex_match(name, wanted))
    {
      return false;
    }
    if (scans_seen == 0)
    {
      label = name;
    }
    else if (name != label)
    {
      warn("scans of '" + name + "' are ignored: '" + label +
               "' came first; choose with sensor_label",
           false);
      return false;
    }
    return true;
  }

  /** Sorts one observation into truths, companions or nothing; true for a wanted scan. */
  [[nodiscard]] bool take(const CObservation::Ptr& observation)
  {
    ++seen_classes[stripped(observation->GetRuntimeClass()->className)];
    if (const auto* robot_pose =
            dynamic_cast<const mrpt::obs::CObservationRobotPose*>(observation.get()))
    {
      if (!options.ground_truth_label.empty() &&
          robot_pose->sensorLabel == options.ground_truth_label)
      {
        truths.push_back({toStamp(robot_pose->timestamp), toPose(robot_pose->pose.mean)});
      }
      return false;
    }
    if (!is3dScan(*observation))
    {
      return false;
    }
    if (endsWith(observation->sensorLabel, time_ring_suffix))
    {
      companion = observation;
      return false;
    }
    return isWanted(*observation);
  }

  static std::string stripped(const std::string& name)
  {
    return name.substr(name.find_last_of(':') + 1);
  }

  /** Whether the scan's time comes after that of the one before. \throws UserError if it never
   * does. */
  [[nodiscard]] bool acceptStamp(const CObservation& observation)
  {
    const bool has_time = observation.timestamp != INVALID_TIMESTAMP;
    const double stamp = toStamp(observation.timestamp);
    if (has_time && (!last_stamp || stamp > *last_stamp))
    {
      last_stamp = stamp;
      dropped_in_a_row = 0;
      return true;
    }
    ++dropped;
    ++dropped_in_a_row;
    warn(!has_time              ? "a scan without a time stamp was dropped"
         : stamp == *last_stamp ? "a scan with the time stamp of the one before was dropped"
                                : "a scan whose time stamp goes back was dropped");
    if (dropped_in_a_row > max_dropped_in_a_row)
    {
      throw UserError(stream.path() + ": the time stamps stand still or run backwards from scan " +
                      std::to_string(scans_seen - max_dropped_in_a_row - 1) +
                      " on; give the file proper times (rawlog-edit, or convert with --dt)");
    }
    return false;
  }

  /** The next wanted scan with a good time stamp, or null at the end or after an error, which is
   * kept in `postponed`. */
  Numbered nextScan()
  {
    try
    {
      while (!postponed)
      {
        const auto observation = stream.next();
        if (!observation)
        {
          return {};
        }
        if (!take(observation))
        {
          continue;
        }
        const std::size_t index = scans_seen++;
        CObservation::Ptr own = std::exchange(companion, nullptr);
        if (acceptStamp(*observation) && index >= static_cast<std::size_t>(options.skip_first_n))
        {
          return {observation, std::move(own), index};
        }
      }
    }
    catch (const UserError& error)
    {
      postponed = error;
    }
    return {};
  }

  void addTimeRing(CObservation* own, Scan& scan)
  {
    if (own == nullptr)
    {
      return;
    }
    const bool fits = own->sensorLabel == scan.sensor_label + time_ring_suffix &&
                      std::abs(toStamp(own->timestamp) - scan.stamp) <= same_time &&
                      applyTimeRing(*own, stream.externalFolder(), scan);
    if (!fits)
    {
      warn("times and rings that do not fit their scan were ignored");
    }
  }

  [[nodiscard]] std::optional<Pose> truthAt(double stamp)
  {
    while (!truths.empty() && truths.front().stamp < stamp - truth_memory)
    {
      truths.pop_front();
    }
    const StampedPose* before = nullptr;
    const StampedPose* after = nullptr;
    for (const StampedPose& truth : truths)
    {
      if (std::abs(truth.stamp - stamp) <= same_time)
      {
        return truth.pose;
      }
      if (truth.stamp < stamp && (before == nullptr || truth.stamp > before->stamp))
      {
        before = &truth;
      }
      if (truth.stamp > stamp && (after == nullptr || truth.stamp < after->stamp))
      {
        after = &truth;
      }
    }
    if (before == nullptr || after == nullptr ||
        stamp - before->stamp > options.ground_truth_max_gap ||
        after->stamp - stamp > options.ground_truth_max_gap)
    {
      return std::nullopt;
    }
    const double fraction = (stamp - before->stamp) / (after->stamp - before->stamp);
    return interpolate(before->pose, after->pose, fraction);
  }

  Frame deliver(const Numbered& scan)
  {
    Frame frame;
    frame.index = scan.index;
    try
    {
      frame.scan = scanFromObservation(*scan.observation, stream.externalFolder());
    }
    catch (const UserError& error)
    {
      throw UserError(stream.path() + ": scan " + std::to_string(frame.index) + ": " +
                      error.what());
    }
    catch (const std::exception& error)
    {
      throw UserError(stream.path() + ": scan " + std::to_string(frame.index) +
                      " is damaged: " + messageOf(error));
    }
    addTimeRing(scan.companion.get(), frame.scan);
    scale_intensity(frame.scan);
    if (frame.scan.size() == 0)
    {
      warn("an empty scan");
    }
    frame.T_world_vehicle_truth = truthAt(frame.scan.stamp);
    ++delivered;
    return frame;
  }

  std::optional<Frame> next()
  {
    const auto limit = static_cast<std::size_t>(options.only_first_n);
    if (limit != 0 && delivered >= limit)
    {
      return std::nullopt;
    }
    if (!pending.observation)
    {
      if (postponed)
      {
        throw UserError(*postponed);
      }
      return std::nullopt;
    }
    // The next scan is looked up first: truth may stand behind its scan.
    Numbered following = nextScan();
    const Numbered current = std::exchange(pending, std::move(following));
    return deliver(current);
  }
};

RawlogSource::RawlogSource(const std::string& path, const RawlogSourceOptions& options)
{
  validate(options, "input");
  mrpt::obs::registerAllClasses_mrpt_obs();
  mrpt::maps::registerAllClasses_mrpt_maps();
  impl_ = std::make_unique<Impl>(path, options);
}

RawlogSource::~RawlogSource() = default;
RawlogSource::RawlogSource(RawlogSource&&) noexcept = default;
RawlogSource& RawlogSource::operator=(RawlogSource&&) noexcept = default;

std::optional<Frame> RawlogSource::next()
{
  return impl_->next();
}
double RawlogSource::progress() const
{
  return impl_->stream.progress();
}
std::size_t RawlogSource::framesRead() const
{
  return impl_->delivered;
}
std::size_t RawlogSource::framesDropped() const
{
  return impl_->dropped;
}
std::string RawlogSource::sensorLabel() const
{
  return impl_->label;
}

std::vector<std::string> RawlogSource::warnings() const
{
  std::vector<std::string> lines;
  for (const Impl::Note& note : impl_->notes)
  {
    const std::string times = note.times > 1 ? std::to_string(note.times) + " times" : "";
    const std::string scan = note.tells_scan ? (times.empty() ? "scan " : ", first scan ") +
                                                   std::to_string(note.first_scan)
                                             : "";
    lines.push_back(impl_->stream.path() + ": " + note.text +
                    (times.empty() && scan.empty() ? "" : " (" + times + scan + ")"));
  }
  return lines;
}
}  // namespace dyslam
