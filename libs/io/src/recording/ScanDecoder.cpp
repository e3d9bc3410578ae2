// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/ScanDecoder.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <cmath>
#include <map>
#include <utility>

#include "FirstLidar.h"
#include "FurtherLidars.h"
#include "FurtherScanChecks.h"
#include "IntensityScaler.h"
#include "LateStamps.h"
#include "MotionSampleReader.h"
#include "RecordingClock.h"
#include "RecordingNotes.h"
#include "TruePoses.h"
#include "rawlog/MrptErrors.h"
#include "rawlog/ObservationScans.h"

namespace dyslam
{
namespace
{
using mrpt::obs::CObservation;

constexpr double same_time = 1e-6;      //!< stamps this near are one [s]
constexpr std::size_t scans_ahead = 3;  //!< read to wait for those of further lidars

bool endsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}
}  // namespace

struct ScanDecoder::Impl
{
  Impl(const RawlogSourceOptions& options_in, std::string name, std::string folder)
      : options(options_in),
        recording(std::move(name)),
        clock(recording),
        external{std::move(folder), options_in.external_anywhere},
        first(options_in.sensor_label),
        motion(options_in),
        further(options_in.further_lidars, options_in.merge_further, options_in.intensity_scale),
        scale_intensity(options_in.intensity_scale),
        selection(options_in),
        truths(options_in.ground_truth_max_gap),
        levelling(options_in.levelling())
  {
  }

  /** Whether a scan is of the first lidar. */
  [[nodiscard]] bool isWanted(const std::string& name)
  {
    const bool is_first = first.takes(name, further);
    if (!is_first && first.mayBe(name, further) && !further.areNamed(name))
    {
      notes.add("scans of '" + name + "' are ignored: '" + first.label() +
                "' came first; choose with sensor_label, or merge them with further_lidars");
    }
    return is_first;
  }

  void holdTimeRing(const CObservation::Ptr& observation)
  {
    std::string name = observation->sensorLabel;
    name.resize(name.size() - std::string(time_ring_suffix).size());
    further.holdTimeRing(name, observation);
    if (first.mayOwnTimeRing(name, further))
    {
      companion = observation;
    }
  }

  /** Holds a scan of a further lidar. \throws UserError for too many lidars. */
  void holdFurther(const CObservation::Ptr& observation)
  {
    if (!further.areMerged())
    {
      return;
    }
    if (observation->timestamp == INVALID_TIMESTAMP)
    {
      notes.add("a scan of a further lidar without a time stamp was dropped");
      return;
    }
    FurtherLidars::HeldScan scan;
    scan.observation = observation;
    scan.time_ring = further.takeTimeRing(observation->sensorLabel);
    scan.late_shift = lateShift(*observation, scan.time_ring.get());
    scan.stamp = toStamp(observation->timestamp) + scan.late_shift + clock.shift();
    try
    {
      further.hold(std::move(scan));
    }
    catch (const UserError& error)
    {
      throw UserError(recording + ": " + error.what());
    }
  }

  /** Classifies one observation as ground truth, companion, motion sensor or neither; true for a
   * wanted scan. */
  [[nodiscard]] bool isScan(const CObservation::Ptr& observation)
  {
    ++seen_classes[stripped(observation->GetRuntimeClass()->className)];
    if (const auto* robot_pose =
            dynamic_cast<const mrpt::obs::CObservationRobotPose*>(observation.get()))
    {
      if (!options.ground_truth_label.empty() &&
          robot_pose->sensorLabel == options.ground_truth_label)
      {
        truths.add(toStamp(robot_pose->timestamp), toPose(robot_pose->pose.mean), clock.shift());
      }
      return false;
    }
    if (motion.take(*observation, clock.shift(), notes) || !is3dScan(*observation))
    {
      return false;
    }
    if (endsWith(observation->sensorLabel, time_ring_suffix))
    {
      holdTimeRing(observation);
      return false;
    }
    if (isWanted(observation->sensorLabel))
    {
      return true;
    }
    if (further.areNamed(observation->sensorLabel))
    {
      holdFurther(observation);
    }
    return false;
  }

  static std::string stripped(const std::string& name)
  {
    return name.substr(name.find_last_of(':') + 1);
  }

  /** Whether the time of scan `index` comes after that of the one before. \throws UserError if it
   * never does. */
  [[nodiscard]] bool acceptStamp(const CObservation& observation,
                                 double late_shift,
                                 std::size_t index)
  {
    const bool has_time = observation.timestamp != INVALID_TIMESTAMP;
    const double shift = clock.shift();
    const RecordingClock::Verdict verdict =
        clock.accept(has_time ? std::optional<double>(toStamp(observation.timestamp) + late_shift)
                              : std::nullopt,
                     index, notes);
    if (verdict.shift != 0)
    {
      truths.shiftClock(shift, verdict.shift);
      motion.shiftClock(verdict.shift);
    }
    return verdict.accepted;
  }

  /** Puts times and rings into the scan of an observation. False if they do not fit. */
  [[nodiscard]] bool addTimeRing(CObservation& time_ring, Scan& scan) const
  {
    return time_ring.sensorLabel == scan.sensor_label + time_ring_suffix &&
           std::abs(toStamp(time_ring.timestamp) - scan.stamp) <= same_time &&
           applyTimeRing(time_ring, external, scan);
  }

  /** The points of an observation, in its lidar's frame, with the stamp as recorded. */
  [[nodiscard]] Scan scanOf(CObservation& observation, CObservation* time_ring, std::size_t index)
  {
    Scan scan = scanFromObservation(observation, external);
    if (time_ring != nullptr && !addTimeRing(*time_ring, scan))
    {
      notes.add("times and rings that do not fit their scan were ignored", index);
    }
    return scan;
  }

  /** Times of the points of a scan that is not decoded yet; none if it is damaged. */
  [[nodiscard]] std::vector<float> timesOf(CObservation& observation, CObservation& time_ring) const
  {
    try
    {
      Scan scan = scanFromObservation(observation, external);
      return addTimeRing(time_ring, scan) ? scan.time : std::vector<float>();
    }
    catch (const std::exception&)
    {
      return {};  // decode() reports it, if the scan is used
    }
  }

  /** RecordedScan::late_shift of the next scan of a lidar. Only times of a companion can be before
   * the stamp: packets and range images count from it.
   * \param time_ring times and rings of its points; null: none */
  [[nodiscard]] double lateShift(CObservation& observation, CObservation* time_ring)
  {
    LateStamps& of_lidar = late_stamps[observation.sensorLabel];
    if (time_ring != nullptr && !of_lidar.isKnown())
    {
      of_lidar.examine(timesOf(observation, *time_ring));
    }
    return of_lidar.shift();
  }

  /** A scan of a further lidar. \param index of the scan that it joins \throws UserError for
   * damaged data. */
  [[nodiscard]] Scan furtherScan(const FurtherLidars::HeldScan& held, std::size_t index)
  {
    const std::string& name = held.observation->sensorLabel;
    try
    {
      Scan part = scanOf(*held.observation, held.time_ring.get(), index);
      moveStamp(held.late_shift, part);
      part.stamp = held.stamp;
      further.intensityScaler(held.lidar)(part);
      return part;
    }
    catch (const UserError& error)
    {
      throw UserError("that of '" + name + "': " + error.what());
    }
    catch (const std::exception& error)
    {
      throw UserError("that of '" + name + "' is damaged: " + messageOf(error));
    }
  }

  /** Adds the scans of further lidars to a decoded one. */
  void joinFurther(double stamp, std::size_t index, Scan& scan)
  {
    for (const FurtherLidars::HeldScan& held : further.takeFor(stamp))
    {
      const Scan part = furtherScan(held, index);
      if (part.size() == 0)
      {
        notes.add("an empty scan of '" + part.sensor_label + "'", index);
        continue;
      }
      further_checks.check(part, held.lidar, scan, notes);
      appendScan(part, held.lidar, scan);
    }
  }

  RawlogSourceOptions options;
  std::string recording;
  RecordingClock clock;
  ExternalFiles external;
  FirstLidar first;
  MotionSampleReader motion;
  FurtherLidars further;
  FurtherScanChecks further_checks;
  IntensityScaler scale_intensity;
  ScanSelection selection;

  CObservation::Ptr companion;  //!< read, its scan not yet
  TruePoses truths;
  Levelling levelling;

  std::size_t scans_seen = 0;  //!< with the wanted label, delivered or not
  bool any_decoded = false;

  std::map<std::string, LateStamps> late_stamps;  //!< by label of the lidar
  std::map<std::string, std::size_t> seen_classes;
  RecordingNotes notes;
};

ScanDecoder::ScanDecoder(const RawlogSourceOptions& options,
                         const std::string& recording,
                         const std::string& external_folder)
{
  validate(options, "input");
  impl_ = std::make_unique<Impl>(options, recording, external_folder);
}
ScanDecoder::~ScanDecoder() = default;
ScanDecoder::ScanDecoder(ScanDecoder&&) noexcept = default;
ScanDecoder& ScanDecoder::operator=(ScanDecoder&&) noexcept = default;

std::optional<RecordedScan> ScanDecoder::take(const CObservation::Ptr& observation)
{
  Impl& s = *impl_;
  if (!s.isScan(observation))
  {
    return std::nullopt;
  }
  const std::size_t index = s.scans_seen++;
  CObservation::Ptr own = std::exchange(s.companion, nullptr);
  const double late_shift = s.lateShift(*observation, own.get());
  if (!s.acceptStamp(*observation, late_shift, index))
  {
    return std::nullopt;
  }
  const bool taken = s.selection.takes(index, *s.clock.last());
  s.further.metScan(*s.clock.last(), taken);
  if (!taken)
  {
    return std::nullopt;
  }
  RecordedScan scan;
  scan.observation = observation;
  scan.time_ring = std::move(own);
  scan.index = index;
  scan.late_shift = late_shift;
  scan.clock_shift = s.clock.shift();
  s.motion.handOver(*s.clock.last(), scan, s.notes);
  return scan;
}

double RecordedScan::stamp() const
{
  return toStamp(observation->timestamp) + late_shift + clock_shift;
}

bool ScanDecoder::isPastEnd() const
{
  return impl_->selection.isPastEnd();
}

double ScanDecoder::progress(double read, std::size_t used)
{
  return impl_->selection.progress(read, used);
}

bool ScanDecoder::waitsForFurther(const RecordedScan& scan) const
{
  const Impl& s = *impl_;
  // Before the first scan all are read ahead, to learn which lidars there are.
  return s.further.areMerged() && s.scans_seen <= scan.index + scans_ahead &&
         !(s.any_decoded && s.further.areCompleteFor(scan.stamp()));
}

Frame ScanDecoder::decode(const RecordedScan& scan)
{
  Impl& s = *impl_;
  s.any_decoded = true;
  Frame frame;
  frame.index = scan.index;
  frame.imu = scan.imu;
  frame.wheels = scan.wheels;
  frame.gnss = scan.gnss;
  try
  {
    frame.scan = s.scanOf(*scan.observation, scan.time_ring.get(), scan.index);
    moveStamp(scan.late_shift, frame.scan);
    frame.scan.stamp += scan.clock_shift;
    s.scale_intensity(frame.scan);
    s.joinFurther(scan.stamp(), scan.index, frame.scan);
  }
  catch (const UserError& error)
  {
    throw UserError(s.recording + ": scan " + std::to_string(frame.index) + ": " + error.what());
  }
  catch (const std::exception& error)
  {
    throw UserError(s.recording + ": scan " + std::to_string(frame.index) +
                    " is damaged: " + messageOf(error));
  }
  s.levelling.apply(frame);
  if (frame.scan.size() == 0)
  {
    s.notes.add("an empty scan", scan.index);
  }
  return frame;
}

std::optional<Pose> ScanDecoder::truthAt(double stamp, double clock_shift)
{
  const auto recorded = impl_->truths.at(stamp - clock_shift, clock_shift);
  return recorded ? std::optional<Pose>(impl_->levelling.levelled(*recorded)) : std::nullopt;
}
std::size_t ScanDecoder::framesDropped() const
{
  return impl_->clock.dropped();
}
std::string ScanDecoder::sensorLabel() const
{
  return impl_->first.label();
}

void ScanDecoder::failWithoutScans(const std::map<std::string, std::size_t>& left_out) const
{
  const Impl& s = *impl_;
  if (s.clock.last())
  {
    throw UserError(s.recording + ": " +
                    s.selection.reasonForNone(s.scans_seen, *s.clock.last() - *s.clock.first()));
  }
  if (s.scans_seen > 0)
  {
    throw UserError(s.recording + ": none of its " + counted(s.scans_seen, "scan") +
                    " has a time stamp; convert it with --dt");
  }
  if (const std::string reason = s.first.reasonForNone(s.further); !reason.empty())
  {
    throw UserError(s.recording + ": " + reason);
  }
  std::string held;
  auto classes = s.seen_classes;
  classes.insert(left_out.begin(), left_out.end());
  for (const auto& [name, count] : classes)
  {
    appendWord(held, std::to_string(count) + " " + name);
  }
  const bool flat = s.seen_classes.count("CObservation2DRangeScan") > 0;
  throw UserError(s.recording + ": has no 3D scans" + (held.empty() ? "" : ", only " + held) +
                  (flat ? "; 2D scans cannot be used" : "") + "; give a recording of a 3D LiDAR");
}

std::vector<std::string> ScanDecoder::warnings() const
{
  std::vector<std::string> lines = impl_->notes.lines(impl_->recording);
  for (const auto& [label, late] : impl_->late_stamps)
  {
    if (late.shift() != 0)
    {
      lines.push_back(impl_->recording + ": the time stamps of '" + printable(label) +
                      "' are late in the scans: moved by " + std::to_string(-late.shift()) +
                      " s to the first points");
    }
  }
  for (const std::string& text : impl_->motion.missing())
  {
    lines.push_back(impl_->recording + ": " + printable(text));
  }
  if (const std::string reason = impl_->further.reasonForNone(); !reason.empty())
  {
    lines.push_back(impl_->recording + ": " + printable(reason));
  }
  if (const std::size_t count = impl_->further.dropped(); count > 0)
  {
    lines.push_back(impl_->recording + ": " + counted(count, "scan") +
                    " of further lidars left out: not within 0.15 s of one of the first lidar");
  }
  return lines;
}
}  // namespace dyslam
