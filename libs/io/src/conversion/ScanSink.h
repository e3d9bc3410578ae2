// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/ScanConverter.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "ConversionOutput.h"
#include "MotionSampleWriter.h"
#include "SectorCheck.h"
#include "SpanCheck.h"
#include "StampCheck.h"
#include "recording/IntensityScaler.h"
#include "recording/MetScans.h"

namespace dyslam
{
constexpr double assumed_dt = 0.1;  //!< between scans without times [s]

/** Skips, limits and re-times scans on their way into the rawlog. */
class ScanSink
{
 public:
  /** \param progress is called after each scan that is written; null for never */
  ScanSink(const std::string& output,
           const ScanConverterOptions& options,
           const ConversionProgress& progress);

  /** Writes a scan. \return false once enough scans were written.
   * \param has_stamp the scan has a time of its own. \param progress part of the work that is done.
   */
  bool put(Scan scan, bool has_stamp, const std::optional<Pose>& T_world_lidar, double progress);

  /** Takes a scan of a further lidar, with its label and T_vehicle_lidar. It is written if the scan
   * of put() that is nearest in time is. */
  void putFurther(Scan scan);
  /** Writes scans of further lidars that still wait for the next one of put(). */
  void putRest();

  /** A sample of another sensor: written before the first scan that is not older. */
  void add(const ImuSample& sample) { motion_.add(sample); }
  void add(const WheelSample& sample) { motion_.add(sample); }
  void add(const GnssFix& fix) { motion_.add(fix); }

  /** The pose of the lidar that a recording has, instead of that of the options: before the first
   * scan. */
  void setMounting(const Pose& T_vehicle_lidar) { T_vehicle_lidar_ = T_vehicle_lidar; }
  [[nodiscard]] std::size_t seen() const { return seen_; }
  [[nodiscard]] std::size_t written() const { return written_; }
  [[nodiscard]] const MotionSampleWriter& motion() const { return motion_; }
  [[nodiscard]] const Pose& T_vehicle_lidar() const { return T_vehicle_lidar_; }
  void note(const std::string& what) { notes_.push_back(what); }
  void warn(const std::string& what) { warnings_.push_back(what); }
  ConversionResult close();
  /** See ConversionOutput::fill(). */
  ConversionResult fill(const std::function<ConversionResult()>& work) { return out_.fill(work); }

 private:
  static constexpr std::size_t most_waiting = 20;  //!< scans of a further lidar

  /** What was seen of a further lidar. */
  struct Further
  {
    IntensityScaler scaler;
    bool times_differ = false;  //!< within a scan so far
    std::size_t waiting = 0;    //!< scans
  };

  /** Writes or drops the waiting scans up to a stamp [s]. */
  void settleFurther(double stamp);
  void settle(Scan scan);

  const ScanConverterOptions& options_;
  ConversionProgress progress_;
  Pose T_vehicle_lidar_;
  ScanSelection selection_;
  ConversionOutput out_;
  IntensityScaler scaler_;
  std::map<std::string, Further> further_;  //!< by label
  std::deque<Scan> waiting_;                //!< of further lidars
  SectorCheck sectors_;
  SpanCheck spans_;
  StampCheck stamps_;
  MetScans met_;  //!< by their own stamps
  MotionSampleWriter motion_;
  std::vector<std::string> notes_;
  std::vector<std::string> warnings_;
  std::size_t seen_ = 0;
  std::size_t written_ = 0;
  bool assumed_rate_ = false;
  bool any_times_ = false;     //!< of points, in the rawlog
  bool times_differ_ = false;  //!< within a scan so far
  bool equal_times_ = false;   //!< scans whose points all have the same time were met before
};
}  // namespace dyslam
