// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "IntensityScaler.h"
#include "LabelPattern.h"

namespace dyslam
{
/** Scans of further lidars of the vehicle, until the scan of the first lidar that each joins. */
class FurtherLidars
{
 public:
  struct HeldScan
  {
    mrpt::obs::CObservation::Ptr observation;
    mrpt::obs::CObservation::Ptr time_ring;  //!< null if it has none
    std::size_t lidar = 1;                   //!< ScanPart::lidar
    double clock_shift = 0;                  //!< to add to its stamp [s]
    double stamp = 0;                        //!< with it [s]
  };

  /** \param labels regex; empty: there are none. \throws UserError if it is no regular expression.
   * \param intensity_scale as RawlogSourceOptions */
  FurtherLidars(const std::string& labels, double intensity_scale);

  /** Whether the option selects a lidar. \param label not the first lidar's */
  [[nodiscard]] bool areNamed(const std::string& label) const;
  /** Holds an observation that carries times and rings of the scan that follows. */
  void holdTimeRing(const mrpt::obs::CObservation::Ptr& observation);
  /** Holds a scan with a time stamp. */
  void hold(const mrpt::obs::CObservation::Ptr& observation, double clock_shift);
  /** The scans that are nearest in time to one of the first lidar, by lidar and stamp; at most
   * `farthest` from it. Others up to then are dropped.
   * \param stamp of it \param next of the one after, if it is known [s] */
  [[nodiscard]] std::vector<HeldScan> takeFor(double stamp, std::optional<double> next);
  /** The next scan of the first lidar. Drops those that are nearer to one before it that was not
   * taken. \param stamp of it [s] \param taken takeFor() follows for it */
  void metScan(double stamp, bool taken);

  [[nodiscard]] IntensityScaler& intensityScaler(std::size_t lidar);
  /** Scans that no scan of the first lidar is near to, so far. */
  [[nodiscard]] std::size_t dropped() const { return dropped_; }
  /** Why nothing is merged, for the user; empty if something was, or nothing was asked for. */
  [[nodiscard]] std::string reasonForNone() const;

 private:
  static constexpr double farthest = 0.15;  //!< from the scan that it joins [s]

  LabelPattern labels_;
  bool wanted_;
  double intensity_scale_;
  std::map<std::string, std::size_t> numbers_;  //!< of the lidars
  std::map<std::string, mrpt::obs::CObservation::Ptr> time_rings_;
  std::map<std::size_t, IntensityScaler> scalers_;
  std::deque<HeldScan> held_;
  std::optional<double> left_out_;  //!< stamp of the last scan of the first lidar, if not taken [s]
  std::size_t dropped_ = 0;
  bool any_taken_ = false;
};
}  // namespace dyslam
