// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/core/Frame.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <dyslam/pipeline/StartSpeed.h>
#include <mrpt/system/CTimeLogger.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace dyslam
{
/** Speed at some time. */
struct TimedSpeed
{
  double stamp = 0;  //!< [s]
  double speed = 0;  //!< [m/s]
};

/** The runs over the first scans of a recording with which findStartSpeed() searches: of the
 * registration alone, started at some speed, and of the whole front end. All speeds are forward
 * speeds [m/s]. */
class StartSearch
{
 public:
  /** \param next, config as of findStartSpeed(); outlive the object. \throws UserError for bad
   * options */
  StartSearch(const NextScan& next, const Config& config);

  [[nodiscard]] const StartOptions& options() const { return options_; }
  /** Whether the settings leave the speed to be searched for. */
  [[nodiscard]] bool isWanted() const;
  /** Reads the first `end` scans. \return whether the recording has them */
  bool readTo(std::size_t end);
  /** Whether wheels measure the speed at the first scan. */
  [[nodiscard]] bool isMeasured() const;

  /** Speed after `scans` scans by registration only. \param start at the first scan; nothing: not
   * known */
  [[nodiscard]] double speedAfter(std::optional<double> start) const;
  /** Whether starts at a lower and a higher speed both drift to a speed. */
  [[nodiscard]] bool isPulledTo(double speed) const;
  /** Drifts of the speeds from `slowest` to `fastest`. */
  [[nodiscard]] std::vector<SpeedDrift> drifts() const;
  /** Speed after the first `scans` scans by the front end, as the run would estimate it. */
  [[nodiscard]] TimedSpeed speedOfRun();
  /** Speed of the run at the first later scans that determine it: starts beside its speed end where
   * it does. */
  [[nodiscard]] std::optional<TimedSpeed> laterSpeed();

 private:
  /** A time logger that is not used. */
  struct NoTimes : mrpt::system::CTimeLogger
  {
    NoTimes() : CTimeLogger(false, "start") {}
  };

  [[nodiscard]] Config startingAt(std::optional<double> speed) const;
  [[nodiscard]] double speedAfter(std::size_t first,
                                  std::optional<double> start,
                                  int of_threads) const;
  [[nodiscard]] std::vector<double> speedsAfter(std::size_t first,
                                                const std::vector<double>& starts) const;
  bool runTo(std::size_t end);

  const NextScan& next_;
  const Config& config_;
  StartOptions options_;
  int threads_ = 0;
  NoTimes times_;
  std::unique_ptr<FrontEnd> front_end_;  //!< of the run from the first scan on
  std::vector<Frame> frames_;            //!< first scans of the recording
  std::vector<double> speeds_;           //!< speed at each scan that the run would estimate [m/s]
  /** Frame::static_prior per frame and point of its scan; empty if the segmenter gives none. */
  std::vector<std::vector<float>> priors_;
};

/** Whether a speed and the probes beside it are possible start speeds: false if the odometry
 * diverged or time stamps are wrong. */
[[nodiscard]] bool isPossibleStart(double speed);

/** A speed for odometry.start_speed [m/s], where zero would mean unknown. */
[[nodiscard]] double knownSpeed(double speed);

/** Limits of odometry.start_speed [m/s]. */
constexpr double min_start_speed = -50;
constexpr double max_start_speed = 100;
/** Difference below which the speeds of two runs count as equal, where single motions swing between
 * rails [m/s]. */
constexpr double same_speed_of_runs = 1;
}  // namespace dyslam
