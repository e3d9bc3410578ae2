// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Ini section `[start]`: speed at the start of a recording that begins in motion. */
struct StartOptions : Options
{
  bool search = true;       //!< search for the initial speed if the first scans do not determine it
  int scans = 10;           //!< number of first scans that may determine the speed
  int compared_scans = 20;  //!< number of first scans with which speeds are compared otherwise
  double slowest = -5;      //!< lowest speed that is tried [m/s]
  double fastest = 45;      //!< highest speed that is tried [m/s]
  double step = 5;          //!< step between the speeds that are tried [m/s]
  double sigma = 1.5;       //!< sigma of a speed that is tried, and of the one found [m/s]
  double min_gain = 0.01;   //!< least gain in fit over the odometry's own speed, as a share

  void describe(OptionsVisitor& visitor) override;
};

/** A run of the registration over the first scans, started at some speed. */
struct StartRun
{
  double speed = 0;  //!< speed after the first `start.scans` scans [m/s]
  /** How well the scans of the second half fit together: the mean share of their points that are
   * inliers of the registration, over the square of the mean RMSE of these [1/m^2]. */
  double fit = 0;
};

/** Chooses the speed under which the world stays still: that of the run whose scans fit together
 * best.
 * \param runs started at several speeds
 * \param own the one started at the speed that the odometry finds by itself
 * \param own_speed of the odometry after the first `start.scans` scans [m/s]
 * \return the speed after as many scans [m/s]; nothing if it is less than 3 m/s from `own_speed`,
 *   or its fit less than `min_gain` better than that of `own`; if it is nearly the speed of `own`,
 *   only above 10 m/s and if `own_speed` differs by 1 m/s: the odometry would find it slowly */
[[nodiscard]] std::optional<double> bestStartSpeed(const std::vector<StartRun>& runs,
                                                   const StartRun& own,
                                                   double own_speed,
                                                   const StartOptions& options);

/** The next scan of a recording, where only index, scan and what was measured with it are filled;
 * nothing after the last one. */
using NextScan = std::function<std::optional<Frame>()>;

/** Searches for the speed at the start of a recording.
 *
 * Between uniform guard rails, in tunnels and in traffic the first scans can be registered at
 * several speeds. If starts 5 m/s slower and faster do not converge to the speed of the odometry,
 * the registration is therefore started at several speeds, and the speed is that under which the
 * scans fit together best: at a wrong one all that is not uniform smears. Points are weighted by
 * the segmenter's appearance prior.
 * \param next called for the first `start.scans` scans, and up to the first `start.compared_scans`
 *   if these leave the speed open
 * \param config config of the run
 * \return the speed [m/s] if the odometry would not find it by itself; nothing if it does, if
 *   `odometry.start_speed` is given or wheels measure the speed, and if nothing is registered or
 *   searched for
 * \throws UserError for bad options */
[[nodiscard]] std::optional<double> findStartSpeed(const NextScan& next, const Config& config);
/** The same for scans that are there already, such as the first ones of a live sensor. */
[[nodiscard]] std::optional<double> findStartSpeed(const std::vector<Frame>& frames,
                                                   const Config& config);

/** Two speeds in the first second of a recording that contradict each other. */
struct SpeedContradiction
{
  double by_wheels = 0;  //!< forward speed by the wheels [m/s]
  double by_scans = 0;   //!< forward speed by the registration without wheels [m/s]
};

/** Compares the speed of the wheels, with which the odometry begins, with that of the scans.
 *
 * A speed in a wrong unit is not noticed later: the local map is built with it, and the next scans
 * are registered where it predicts them. The first `start.scans` scans are therefore registered
 * without the wheels, and with them.
 * \param next called for the first `start.scans` scans
 * \param config config of the run
 * \return the speeds at the last of these scans, if they differ by more than 0.5 m/s and 30 %, the
 *   registration without wheels converges to its speed from 5 m/s slower and faster, and its scans
 *   fit together clearly better than with the wheels; nothing otherwise, if wheels do not measure
 *   the speed at the first scan, and if no start speed is searched for (`start.search`)
 * \throws UserError for bad options */
[[nodiscard]] std::optional<SpeedContradiction> findWheelContradiction(const NextScan& next,
                                                                       const Config& config);
/** The same for scans that are there already. */
[[nodiscard]] std::optional<SpeedContradiction> findWheelContradiction(
    const std::vector<Frame>& frames, const Config& config);
/** The warning about it, one sentence. \param are_used the wheels are used nevertheless */
[[nodiscard]] std::string warningOf(const SpeedContradiction& contradiction, bool are_used);

/** Sets the speed at the start of a run: `odometry.start_speed`, rounded to 0.1 m/s, with
 * `start.sigma` as its standard deviation.
 * \param speed speed at the first scan [m/s] \throws UserError for a bad `start.sigma`. */
void setStartSpeed(double speed, Config& config);
}  // namespace dyslam
