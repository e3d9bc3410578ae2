// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSink.h"

#include <dyslam/base/Files.h>
#include <dyslam/core/PointTimes.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace dyslam
{
namespace
{
/** Whether the points have two different times or more. */
bool haveDifferentTimes(const Scan& scan)
{
  return timeExtent(scan.time).value_or(TimeExtent()).duration() > 0;
}
/** Where the true poses are from: file of a folder of scans or topic of a bag. */
PoseOrigin poseOriginOf(const ScanConverterOptions& options)
{
  const bool is_said = options.pose_source != PoseSource::unknown;
  return {is_said ? options.pose_source : PoseSource::given,
          options.poses.empty() ? options.truth_topic : nameOfFile(options.poses)};
}
}  // namespace

ScanSink::ScanSink(const std::string& output,
                   const ScanConverterOptions& options,
                   const ConversionProgress& progress)
    : options_(options),
      progress_(progress),
      T_vehicle_lidar_(poseFromOption("--sensor-pose", options.sensor_pose)),
      selection_(options, options.every_n),
      out_(output, options, poseOriginOf(options))
{
}

bool ScanSink::put(Scan scan,
                   bool has_stamp,
                   const std::optional<Pose>& T_world_lidar,
                   double progress)
{
  const std::size_t number = seen_++;
  const auto first = static_cast<std::size_t>(options_.skip_first_n);
  const bool assume_rate = (options_.dt > 0 && !options_.by_number) || !has_stamp;
  const double dt = options_.dt > 0 ? options_.dt : assumed_dt;
  const double recorded = assume_rate ? static_cast<double>(number) * dt : scan.stamp;
  const auto limit = static_cast<std::size_t>(options_.only_first_n);
  const bool is_enough = limit != 0 && written_ >= limit;
  const bool is_taken = !is_enough && selection_.takes(number, recorded);
  met_.add(scan.stamp, is_taken);
  settleFurther(scan.stamp);
  if (!is_taken)
  {
    motion_.skip(recorded);
    return !is_enough && !selection_.isPastEnd();
  }
  scaler_(scan);
  if (assume_rate)
  {
    assumed_rate_ = assumed_rate_ || options_.dt <= 0;
    scan.stamp = static_cast<double>(number - first) * dt;
  }
  if (scan.sensor_label.empty())
  {
    scan.sensor_label = options_.firstLabel();
  }
  scan.T_vehicle_lidar = T_vehicle_lidar_;
  sectors_.add(scan);
  if (!assume_rate)
  {
    spans_.add(number, scan);
    stamps_.add(scan.stamp);
  }
  times_differ_ = times_differ_ || haveDifferentTimes(scan);
  if (!times_differ_ && scan.time.size() > 1)
  {
    scan.time.clear();  // all the same: a column that no driver filled
    equal_times_ = true;
  }
  any_times_ = any_times_ || !scan.time.empty();
  motion_.writeUpTo(scan.stamp, out_);
  out_.write(scan, T_world_lidar);
  ++written_;
  const double of_limit =
      limit == 0 ? 0 : static_cast<double>(written_) / static_cast<double>(limit);
  out_.reportProgress(progress_, std::max(progress, of_limit));
  // With further lidars the next scan shows which of theirs belong to the last one.
  return limit == 0 || written_ < limit || !options_.further_topics.empty();
}

void ScanSink::putFurther(Scan scan)
{
  const std::string label = scan.sensor_label;
  waiting_.push_back(std::move(scan));
  if (++further_[label].waiting > most_waiting)
  {
    const auto oldest =
        std::find_if(waiting_.begin(), waiting_.end(),
                     [&label](const Scan& other) { return other.sensor_label == label; });
    Scan first = std::move(*oldest);
    waiting_.erase(oldest);
    settle(std::move(first));
  }
}

void ScanSink::putRest()
{
  settleFurther(std::numeric_limits<double>::infinity());
}

void ScanSink::settleFurther(double stamp)
{
  const auto due =
      std::stable_partition(waiting_.begin(), waiting_.end(),
                            [stamp](const Scan& scan) { return !(scan.stamp <= stamp); });
  std::for_each(due, waiting_.end(), [this](Scan& scan) { settle(std::move(scan)); });
  waiting_.erase(due, waiting_.end());
}

void ScanSink::settle(Scan scan)
{
  Further& lidar = further_[scan.sensor_label];
  --lidar.waiting;
  if (met_.empty() || !met_.nearestTo(scan.stamp).is_used)
  {
    return;
  }
  lidar.scaler(scan);
  lidar.times_differ = lidar.times_differ || haveDifferentTimes(scan);
  if (!lidar.times_differ && scan.time.size() > 1)
  {
    scan.time.clear();
  }
  out_.writeFurther(scan);
}

ConversionResult ScanSink::close()
{
  ConversionResult result = out_.close();
  if (assumed_rate_)
  {
    warn(
        "the scans have no times: 0.1 s between scans is assumed; give --dt, or a file of times "
        "with --times of scans2rawlog");
  }
  if (sectors_.areSectors())
  {
    warn(
        "the scans are only sectors of a revolution, which dyslam cannot register; record whole "
        "revolutions with the lidar's driver, or its packets");
  }
  if (const std::string warning = spans_.warning(); !warning.empty())
  {
    warn(warning);
  }
  for (const std::string& warning : stamps_.warnings())
  {
    warn(warning);
  }
  if (!any_times_)
  {
    const std::string deskewing =
        ": dyslam deskews by their order, by azimuth or not at all (preprocess.deskew)";
    if (equal_times_)
    {
      warn("the points have no times (those of a scan are all the same)" + deskewing);
    }
    else
    {
      note("the points have no times" + deskewing);
    }
    if (options_.every_n > 1)
    {
      warn(thinned_without_times);
    }
  }
  result.notes = notes_;
  result.warnings = warnings_;
  return result;
}
}  // namespace dyslam
