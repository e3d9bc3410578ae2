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
  /** Reads up to the first `end` scans. \return number of scans read so far */
  std::size_t readTo(std::size_t end);
  /** Whether wheels measure the speed at the first scan, by their samples up to the second one.
   * \pre two scans have been read */
  [[nodiscard]] bool isMeasured() const;
  /** Speed by the wheels at the last scan that was read; nothing without their samples there.
   * \pre a scan has been read */
  [[nodiscard]] std::optional<double> speedByWheels() const;
  /** The scans that were read. */
  [[nodiscard]] const std::vector<Frame>& frames() const { return frames_; }

  /** Run over all scans read, started as the settings and the wheels state. */
  [[nodiscard]] StartRun run() const;
  /** Speed after the first `scans` scans by registration only. \param start at the first scan;
   * nothing: not known */
  [[nodiscard]] double speedAfter(std::optional<double> start) const;
  /** Whether starts at a lower and a higher speed both converge to a speed over the first `scans`
   * scans. */
  [[nodiscard]] bool isPulledTo(double speed) const;
  /** Speed after the first `scans` scans by the front end, as the run would estimate it. The points
   * of all runs from then on are weighted by its appearance priors. */
  [[nodiscard]] double speedOfRun();
  /** Runs over all scans read, started at several speeds. */
  [[nodiscard]] std::vector<StartRun> runsFrom(const std::vector<double>& starts);

 private:
  /** Lets the front end process the next scan. */
  void processNext();
  [[nodiscard]] Config startingAt(std::optional<double> speed) const;
  [[nodiscard]] StartRun runFrom(std::optional<double> start,
                                 std::size_t scans,
                                 int of_threads) const;
  [[nodiscard]] std::vector<StartRun> runsFrom(const std::vector<double>& starts,
                                               std::size_t scans) const;

  const NextScan& next_;
  const Config& config_;
  StartOptions options_;
  int threads_ = 0;
  mrpt::system::CTimeLogger times_{false};  //!< records nothing
  std::unique_ptr<FrontEnd> front_end_;     //!< of the run from the first scan on
  std::vector<Frame> frames_;               //!< first scans of the recording
  std::size_t processed_ = 0;               //!< number of scans that the front end has processed
  double speed_of_run_ = 0;                 //!< its speed at the last one [m/s]
  bool gives_priors_ = true;  //!< the segmenter gave a prior for the last one with points
  /** Frame::static_prior per frame and point of its scan; empty if the segmenter gives none. */
  std::vector<std::vector<float>> priors_;
};

/** StartRun::fit of several scans. */
class FitMean
{
 public:
  /** \param motion of a scan by the registration \param points number of points of its cloud */
  void add(const MotionEstimate& motion, std::size_t points);
  [[nodiscard]] double value() const;

 private:
  double inlier_share_ = 0;  //!< sum over the scans
  double rmse_ = 0;          //!< sum over the scans with inliers [m]
  double scans_ = 0;
  double with_inliers_ = 0;  //!< number of scans with inliers
};

/** Whether a speed and the probes beside it are possible start speeds: false if the odometry
 * diverged or time stamps are wrong. */
[[nodiscard]] bool isPossibleStart(double speed);

/** A speed for odometry.start_speed [m/s], where zero would mean unknown. */
[[nodiscard]] double knownSpeed(double speed);
}  // namespace dyslam
