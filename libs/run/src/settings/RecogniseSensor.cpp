// SPDX-License-Identifier: BSD-3-Clause
// The sensor of a recording, from its first scans.
#include <dyslam/base/Error.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/run/RecordedSensor.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "RecordedGround.h"
#include "SensorDescription.h"

namespace dyslam
{
namespace
{
/** Number of full scans that are examined, and of scans that are read to find them. */
constexpr int examined_scans = 5;
constexpr int most_examined = 50;
/** Least number of returns of a full scan, as a share of the scan with most returns. */
constexpr double full_share = 0.5;
/** Rings of a scan are accepted if another full scan has this share of their number. */
constexpr double same_rings = 0.9;
/** If the ground is inclined, it is also measured in every fifth scan after the examined ones: the
 * vehicle pitches and rolls. */
constexpr int ground_step = 5;

/** Share of the returns above the lidar, along the vehicle's z axis. */
double shareAbove(const Scan& scan)
{
  const Eigen::Vector3f up = scan.T_vehicle_lidar.linear().row(2).cast<float>();
  std::size_t returns = 0;
  std::size_t above = 0;
  for (const Eigen::Vector3f& p : scan.points)
  {
    returns += isReturn(p) ? 1U : 0U;
    above += isReturn(p) && up.dot(p) > 0 ? 1U : 0U;
  }
  return returns > 0 ? static_cast<double>(above) / static_cast<double>(returns) : 0;
}

/** Collects properties of a sensor from its scans. Scans with few returns, as when a sensor starts,
 * are not used. */
class ExaminedScans
{
 public:
  void add(const Scan& scan)
  {
    shown_.push_back({measureScanPattern(scan), shareAbove(scan)});
    richest_ = std::max(richest_, shown_.back().pattern.returns);
    sensor_.has_times = sensor_.has_times || !scan.time.empty();
    times_differ_ = times_differ_ || shown_.back().pattern.point_times;
    stamps_.push_back(scan.stamp);
  }
  [[nodiscard]] bool empty() const { return stamps_.empty(); }
  /** Least number of returns of a full scan, by the scans so far. */
  [[nodiscard]] std::size_t minReturns() const
  {
    return static_cast<std::size_t>(std::ceil(full_share * static_cast<double>(richest_)));
  }
  [[nodiscard]] bool areEnough() const
  {
    const auto full =
        std::count_if(shown_.begin(), shown_.end(), [this](const Shown& s) { return isFull(s); });
    return full >= examined_scans || shown_.size() >= most_examined;
  }
  [[nodiscard]] RecordedSensor sensor() const
  {
    std::vector<double> periods;
    for (std::size_t i = 1; i < stamps_.size(); ++i)
    {
      periods.push_back(stamps_[i] - stamps_[i - 1]);
    }
    RecordedSensor sensor = sensor_;
    const Shown best = clearest();
    sensor.pattern = best.pattern;
    sensor.share_above = best.share_above;
    sensor.scans = shown_.size();
    sensor.equal_times = sensor.has_times && !times_differ_;
    sensor.period = periods.empty() ? 0 : upperMedian(periods);
    return sensor;
  }

 private:
  struct Shown
  {
    ScanPattern pattern;
    double share_above = 0;
  };

  [[nodiscard]] bool isFull(const Shown& s) const
  {
    return s.pattern.returns > 0 && s.pattern.returns >= minReturns();
  }
  /** Whether another full scan shows about as many rings, unless there is none. */
  [[nodiscard]] bool isConfirmed(const Shown& s) const
  {
    std::size_t others = 0;
    const double least = same_rings * static_cast<double>(s.pattern.rings.size());
    for (const Shown& other : shown_)
    {
      if (&other != &s && isFull(other))
      {
        ++others;
        if (static_cast<double>(other.pattern.rings.size()) >= least)
        {
          return true;
        }
      }
    }
    return others == 0;
  }
  /** The full scan with most rings; without rings, the one with most returns. */
  [[nodiscard]] Shown clearest() const
  {
    Shown best;
    for (const Shown& s : shown_)
    {
      const bool better = s.pattern.rings.size() > best.pattern.rings.size() ||
                          (!best.pattern.hasRings() && s.pattern.returns > best.pattern.returns);
      if (better && isFull(s) && isConfirmed(s))
      {
        best = s;
      }
    }
    return best;
  }

  std::vector<Shown> shown_;
  std::size_t richest_ = 0;  //!< largest number of returns of a scan
  RecordedSensor sensor_;
  bool times_differ_ = false;  //!< the points of a scan have different times
  std::vector<double> stamps_;
};

/** Whether the lidar looks downwards about as far as upwards. A plane above a lidar that looks
 * mostly upwards may be a ceiling. */
bool wouldSeeGroundBelow(const ScanPattern& pattern)
{
  constexpr double same_angle = 0.9;
  return (pattern.hasRings() || isDenseRevolution(pattern)) &&
         -pattern.lowest >= same_angle * pattern.highest;
}

/** Sensor and ground by the first scans. */
class SensorExamination
{
 public:
  /** Adds a scan; of several lidars only the first one is examined. */
  void add(const Scan& scan)
  {
    if (!scan.parts.empty())
    {
      add(ownScan(scan));
      return;
    }
    ++added_;
    const bool only_ground = scans_.areEnough();
    if (!only_ground)
    {
      scans_.add(scan);
    }
    const auto returns =
        static_cast<std::size_t>(std::count_if(scan.points.begin(), scan.points.end(), isReturn));
    if (returns > 0 && returns >= scans_.minReturns() &&
        (!only_ground || added_ % ground_step == 0))
    {
      ground_.add(scan, returns);
    }
  }
  [[nodiscard]] bool empty() const { return scans_.empty(); }
  [[nodiscard]] bool isDone() const
  {
    return scans_.areEnough() && (added_ >= most_examined || !isInclined(sensor().ground));
  }
  [[nodiscard]] RecordedSensor sensor() const
  {
    RecordedSensor sensor = scans_.sensor();
    sensor.ground = ground_.plane(GroundSide::below, scans_.minReturns());
    if (!sensor.ground && wouldSeeGroundBelow(sensor.pattern))
    {
      sensor.ground = ground_.plane(GroundSide::above, scans_.minReturns());
    }
    return sensor;
  }

 private:
  ExaminedScans scans_;
  RecordedGround ground_;
  int added_ = 0;
};
}  // namespace

RecordedSensor recogniseSensor(const std::string& rawlog, const RawlogSourceOptions& input)
{
  RawlogSourceOptions options = input;
  options.merge_further = false;
  options.roll = 0;
  options.pitch = 0;
  options.only_first_n =
      input.only_first_n > 0 ? std::min(input.only_first_n, most_examined) : most_examined;
  RawlogSource source(rawlog, options);
  SensorExamination examination;
  try
  {
    while (!examination.isDone())
    {
      const auto frame = source.next();
      if (!frame)
      {
        break;
      }
      examination.add(frame->scan);
    }
  }
  catch (const UserError&)
  {
    if (examination.empty())
    {
      throw;
    }
    // The run reports damage after the first scan.
  }
  return examination.sensor();
}

RecordedSensor recogniseSensor(const std::vector<Frame>& frames)
{
  if (frames.empty())
  {
    throw std::invalid_argument("recogniseSensor: no frames");
  }
  SensorExamination examination;
  for (std::size_t i = 0; i < frames.size() && !examination.isDone(); ++i)
  {
    examination.add(frames[i].scan);
  }
  return examination.sensor();
}
}  // namespace dyslam
