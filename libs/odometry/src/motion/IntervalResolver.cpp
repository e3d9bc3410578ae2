// SPDX-License-Identifier: BSD-3-Clause
#include "IntervalResolver.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double clearly_better = 0.02;  // difference of inlier shares
/** Least inlier share, relative to the usual one. On a street a scan is also registered metres from
 * its place: houses and road fit there, too, and the prior determines the forward motion. */
constexpr double least_share = 0.8;
constexpr double usual_period = 0.1;  // of a lidar whose rate is not known yet [s]
}  // namespace

void IntervalResolver::resolve(const Pose& T_odom_previous,
                               const PrepareCloud& prepare,
                               Frame& frame,
                               FrameContext& context)
{
  const double interval = predictor_.clock().interval();
  const double period = predictor_.clock().period();
  const std::optional<Pose> T_found = findMotion(T_odom_previous, prepare, frame, context);
  const bool clock_set = T_found ? predictor_.showsClockStep(*T_found) : interval <= 0;
  const double passed = !clock_set ? interval : period > 0 ? period : usual_period;
  predictor_.correctInterval(passed, frame, context);
  if (T_found && !clock_set)
  {
    frame.prior.T_previous_current = *T_found;
  }
  frame.T_odom_vehicle = T_odom_previous * frame.prior.T_previous_current;
  // Beyond the extrapolation the prior covers a part of dt; the sweep is deskewed by its velocity.
  const double beyond = frame.dt / ScanClock::max_extrapolation;
  frame.cloud = prepare(context.after_gap && !T_found
                            ? expSE3(beyond * logSE3(frame.prior.T_previous_current))
                            : frame.prior.T_previous_current,
                        frame.dt);
}

/** Motion since the previous scan, over an unknown interval: by the initial guess that registers
 * best, of constant velocity for the interval, constant velocity for one period, and no motion.
 * \return nothing without a map of at least two scans, or if no guess registers as well as usual */
std::optional<Pose> IntervalResolver::findMotion(const Pose& T_odom_previous,
                                                 const PrepareCloud& prepare,
                                                 const Frame& frame,
                                                 const FrameContext& context)
{
  if (registration_.framesInMap() < 2)
  {
    return std::nullopt;
  }
  const double interval = predictor_.clock().interval();
  const double period = predictor_.clock().period();
  std::vector<std::pair<double, MotionPrior>> guesses;  // dt [s] and prior over it
  if (interval > 0 && interval <= ScanClock::max_extrapolation)
  {
    guesses.emplace_back(interval, predictor_.priorAfter(interval));
    (void)predictor_.fuseSensed(interval, context, guesses.back().second);
  }
  guesses.emplace_back(period, predictor_.priorAfter(period));
  if (interval > 0)
  {
    guesses.emplace_back(interval,
                         predictor_.priorAfter(std::min(interval, ScanClock::max_extrapolation)));
    guesses.back().second.T_previous_current = Pose::Identity();
  }
  Frame trial = frame;
  std::optional<Pose> T_best;
  double best_share = 0;  // of the inliers
  const double least = least_share * registration_.usualInlierShare();
  for (const auto& [dt, prior] : guesses)
  {
    trial.dt = dt;
    trial.prior = prior;
    trial.cloud = prepare(prior.T_previous_current, dt);
    const RegistrationResult found =
        registration_.align(trial, T_odom_previous * prior.T_previous_current, &prior).result();
    if (found.motion.converged() && found.inlier_share >= least &&
        (!T_best || found.inlier_share > best_share + clearly_better))
    {
      T_best = found.motion.T_previous_current;
      best_share = found.inlier_share;
    }
  }
  return T_best;
}
}  // namespace dyslam
