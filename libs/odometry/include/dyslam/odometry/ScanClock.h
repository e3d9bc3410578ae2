// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

class MotionFilter;

/** Determines the time between scans. Stamps are trusted, unless an interval does not fit the
 * sensor's rate: then scans may be missing, or the clock of the stamps may have been set. */
class ScanClock
{
 public:
  /** Longest gap over which the motion is predicted by a constant velocity [s]. */
  static constexpr double max_extrapolation = 2;

  /** Adds the stamp of the next scan [s]. \throws std::invalid_argument if it is not finite. */
  void advance(double stamp);
  /** Whether the interval before the last scan fits neither the sensor's rate nor, where scans
   * are missing, one of the last intervals. */
  [[nodiscard]] bool isDoubtful() const;
  /** Duration of the last scan's sweep: interval(), or period() where that does not fit the rate
   * [s]. */
  [[nodiscard]] double sweepDuration() const { return fitsRate() ? interval_ : period(); }
  /** advance(), sweepDuration() and settle() for a scan with a trusted stamp: for programs that
   * place scans along a given trajectory. \return duration of the sweep [s] */
  double nextSweep(double stamp);
  /** Stamp of the last scan minus that of the previous one [s]; 0 for the first scan. */
  [[nodiscard]] double interval() const { return interval_; }
  /** Median of the last intervals that were accepted [s]; of those over missing scans the part of
   * one scan; 0 without any. */
  [[nodiscard]] double period() const;
  /** Decides how much time has passed since the previous scan.
   * \param passed interval() or, where the clock was set, period() [s] */
  void settle(double passed);
  /** Stamp of the last scan minus its time by a clock that was never set [s]. */
  [[nodiscard]] double offset() const { return offset_; }
  /** Warnings about a clock that was set and about missing scans. */
  [[nodiscard]] std::vector<std::string> warnings() const;
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

 private:
  [[nodiscard]] bool fitsRate() const;
  [[nodiscard]] bool scansAreMissing() const;

  bool started_ = false;        //!< there was a scan
  double stamp_ = 0;            //!< stamp of the last scan [s]
  double interval_ = 0;         //!< stamp of the last scan minus that of the previous one [s]
  double offset_ = 0;           //!< sum of the clock's steps [s]
  std::deque<double> regular_;  //!< last intervals that were accepted, newest last [s]
  std::size_t scans_ = 0;       //!< number of scans
  std::size_t gaps_ = 0;        //!< number of intervals in which scans are missing
  std::size_t missing_ = 0;     //!< number of scans that are missing
  std::size_t steps_ = 0;       //!< number of times that the clock was set
  std::size_t first_step_ = 0;  //!< index of the scan after the first step, from 0
  double largest_step_ = 0;     //!< step of the largest magnitude [s]
};

/** Whether the motion between two scans fits one period rather than the interval between their
 * stamps. For a standing vehicle, where both fit, the stamps are trusted.
 * \param filter state before the scan */
[[nodiscard]] bool showsClockStep(const MotionFilter& filter,
                                  double interval,
                                  double period,
                                  const Pose& T_previous_current);
}  // namespace dyslam
