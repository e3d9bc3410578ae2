// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <deque>
#include <string>

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

  /** Adds the stamp of the next scan [s]. */
  void advance(double stamp);
  /** Whether the interval of the last scan does not fit the rate. */
  [[nodiscard]] bool isDoubtful() const;
  /** Duration of the last sweep [s]: interval(), or period() if that does not fit the rate. */
  [[nodiscard]] double sweepDuration() const { return isDoubtful() ? period() : interval_; }
  /** advance(), sweepDuration() and settle() for a scan with a trusted stamp: for programs that
   * place scans along a given trajectory. \return duration of the sweep [s] */
  double nextSweep(double stamp);
  /** Time between the last two scans by their stamps [s]. */
  [[nodiscard]] double interval() const { return interval_; }
  /** Median of earlier intervals [s]; 0 while too few are known. */
  [[nodiscard]] double period() const;
  /** Sets the time that has passed between the last two scans [s]: interval() or, if the clock was
   * set, period(). */
  void settle(double passed);
  /** Stamp of the last scan minus its time by a clock that was never set [s]. */
  [[nodiscard]] double offset() const { return offset_; }
  /** Warning about a clock that was set; empty if it was never set. */
  [[nodiscard]] std::string warning() const;
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

 private:
  bool started_ = false;
  double stamp_ = 0;
  double interval_ = 0;
  double offset_ = 0;
  std::deque<double> regular_;  // intervals that fit the rate [s], newest last
  std::size_t scans_ = 0;
  std::size_t steps_ = 0;
  std::size_t first_step_ = 0;  // number of the scan, from 0
  double largest_step_ = 0;     // largest step of the clock [s]
};

/** Whether the motion between two scans fits one period rather than the interval between their
 * stamps. For a standing vehicle, where both fit, the stamps are trusted.
 * \param filter state before the scan */
[[nodiscard]] bool showsClockStep(const MotionFilter& filter,
                                  double interval,
                                  double period,
                                  const Pose& T_previous_current);
}  // namespace dyslam
