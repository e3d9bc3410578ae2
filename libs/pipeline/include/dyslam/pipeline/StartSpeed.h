// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Config.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct RawlogSourceOptions;

/** Ini section `[start]`: speed at the start of a recording that begins in motion. */
struct StartOptions : Options
{
  bool search = true;     //!< search for the initial speed if the first scans do not determine it
  int scans = 10;         //!< number of first scans used in the search
  double slowest = -5;    //!< lowest speed that is tried [m/s]
  double fastest = 45;    //!< highest speed that is tried [m/s]
  double step = 5;        //!< step between the speeds that are tried [m/s]
  double sigma = 1.5;     //!< sigma of a speed that is tried, and of the one found [m/s]
  double max_drift = 2;   //!< limit of the change of a tried speed over the scans [m/s]
  double min_margin = 6;  //!< least support beyond that of the odometry's own speed [m^2/s^2]

  void describe(OptionsVisitor& visitor) override;
};

/** One speed that was tried. */
struct SpeedDrift
{
  double speed = 0;  //!< at the first scan [m/s]
  double drift = 0;  //!< by which the odometry that began with it has moved away from it [m/s]
};

/** The speed towards which the speeds around it drift: the maximum of the integral of the drift
 * over the speed.
 * \param drifts two at least, ascending by speed \param start what the odometry finds by itself
 * \return the speed at the first scan [m/s]; nothing where its integral is less than `min_margin`
 *   above that of `start` */
[[nodiscard]] std::optional<double> speedOfDrifts(const std::vector<SpeedDrift>& drifts,
                                                  double start,
                                                  const StartOptions& options);

/** Searches for the speed at the start of a recording.
 *
 * Between guard rails that look alike all along, or amid traffic, the first scans can be registered
 * at several speeds. The odometry is started at each of several speeds. The few informative points
 * pull a wrong speed towards the true one, scan after scan; so the drift of the speeds shows the
 * true one even if none of them reaches it. Points are weighted by the segmenter's appearance
 * prior.
 * \param frames the first scans of a recording; those without dt, poses and so on
 * \param config of the run
 * \return the speed [m/s] where the odometry would not find it by itself; nothing where it does,
 *   where `odometry.start_speed` is given or wheels measure the speed, and where nothing is
 *   registered or searched for
 * \throws UserError for bad options */
[[nodiscard]] std::optional<double> findStartSpeed(const std::vector<Frame>& frames,
                                                   const Config& config);

/** The same for the first scans of a rawlog. */
[[nodiscard]] std::optional<double> findStartSpeed(const std::string& rawlog,
                                                   const RawlogSourceOptions& input,
                                                   const Config& config);

/** Lets a run begin at a speed that findStartSpeed() has found: `odometry.start_speed`, rounded to
 * 0.1 m/s, with `start.sigma` as its standard deviation.
 * \param speed at the first scan [m/s] \throws UserError for a bad `start.sigma`. */
void setStartSpeed(double speed, Config& config);
}  // namespace dyslam
