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
  bool search = true;     //!< search for the initial speed if the first scans do not determine it
  int scans = 10;         //!< number of first scans used in the search
  int look_ahead = 40;    //!< number of further scans used if the first leave the speed open
  double slowest = -5;    //!< lowest speed that is tried [m/s]
  double fastest = 45;    //!< highest speed that is tried [m/s]
  double step = 5;        //!< step between the speeds that are tried [m/s]
  double sigma = 1.5;     //!< sigma of a speed that is tried, and of the one found [m/s]
  double max_drift = 2;   //!< limit of the change of a tried speed over the scans [m/s]
  double min_margin = 6;  //!< least support above that of the odometry's own speed [m^2/s^2]

  void describe(OptionsVisitor& visitor) override;
};

/** One speed that was tried. */
struct SpeedDrift
{
  double speed = 0;  //!< speed at the first scan [m/s]
  double drift = 0;  //!< change of the speed by the odometry that was started with it [m/s]
};

/** Speed towards which the speeds around it drift: the maximum of the integral of the drift over
 * the speed.
 * \param drifts at least two, ascending by speed \param start speed that the odometry finds by
 * itself \return the speed at the first scan [m/s]; nothing if its integral is less than
 * `min_margin` above that of `start` */
[[nodiscard]] std::optional<double> speedOfDrifts(const std::vector<SpeedDrift>& drifts,
                                                  double start,
                                                  const StartOptions& options);

/** Support of a speed: the integral of the drift over the speed, from the first speed tried up to
 * it, largest at the speed towards which those around it drift. Drifts are clamped to
 * `options.max_drift`. \param drifts at least two, ascending by speed [m^2/s^2] */
[[nodiscard]] double supportOf(const std::vector<SpeedDrift>& drifts,
                               double speed,
                               const StartOptions& options);

/** The next scan of a recording, where only index, scan and what was measured with it are filled;
 * nothing after the last one. */
using NextScan = std::function<std::optional<Frame>()>;

/** Searches for the speed at the start of a recording.
 *
 * Between uniform guard rails, or in traffic, the first scans can be registered at several speeds.
 * The odometry is therefore started at several speeds. The few informative points pull a wrong
 * speed towards the true one from scan to scan, so that the drift of the speeds shows the true
 * speed even if none of them reaches it. If the drifts are too small to show it, later scans are
 * used: the speed where starts at several speeds end at the same one. Points are weighted by the
 * segmenter's appearance prior.
 * \param next called for the first `start.scans` scans, and for up to `start.look_ahead` further
 *   ones if these leave the speed open
 * \param config config of the run
 * \return the speed [m/s] if the odometry would not find it by itself; nothing if it does, if
 *   `odometry.start_speed` is given or wheels measure the speed, and if nothing is registered or
 *   searched for
 * \throws UserError for bad options */
[[nodiscard]] std::optional<double> findStartSpeed(const NextScan& next, const Config& config);
/** The same for scans that are there already, such as the first ones of a live sensor. */
[[nodiscard]] std::optional<double> findStartSpeed(const std::vector<Frame>& frames,
                                                   const Config& config);

/** Sets the speed at the start of a run: `odometry.start_speed`, rounded to 0.1 m/s, with
 * `start.sigma` as its standard deviation.
 * \param speed speed at the first scan [m/s] \throws UserError for a bad `start.sigma`. */
void setStartSpeed(double speed, Config& config);
}  // namespace dyslam
