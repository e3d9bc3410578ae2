// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/StartSpeed.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
/** Difference to the odometry's speed below which a speed is not reported [m/s]. */
constexpr double min_difference = 3;

/** Speed at which the drift, interpolated linearly, changes from forward to backward.
 * \return the lower speed if it does not */
double crossing(const SpeedDrift& lower, const SpeedDrift& upper)
{
  if (lower.drift <= 0 || upper.drift >= 0)
  {
    return lower.speed;
  }
  return lower.speed + (upper.speed - lower.speed) * lower.drift / (lower.drift - upper.drift);
}

/** Integral of the drift over the speed, from the first speed on [m^2/s^2]. */
double support(const std::vector<SpeedDrift>& drifts, double speed)
{
  double sum = 0;
  for (std::size_t i = 1; i < drifts.size() && drifts[i - 1].speed < speed; ++i)
  {
    const SpeedDrift& a = drifts[i - 1];
    const SpeedDrift& b = drifts[i];
    const double share = std::min(1.0, (speed - a.speed) / (b.speed - a.speed));
    const double end = a.drift + share * (b.drift - a.drift);
    sum += share * (b.speed - a.speed) * (a.drift + end) / 2;
  }
  return sum;
}
std::vector<SpeedDrift> limitedDrifts(const std::vector<SpeedDrift>& drifts, double max_drift)
{
  std::vector<SpeedDrift> limited = drifts;
  for (SpeedDrift& tried : limited)
  {
    tried.drift = std::clamp(tried.drift, -max_drift, max_drift);
  }
  return limited;
}
}  // namespace

double supportOf(const std::vector<SpeedDrift>& drifts, double speed, const StartOptions& options)
{
  return support(limitedDrifts(drifts, options.max_drift), speed);
}

std::optional<double> speedOfDrifts(const std::vector<SpeedDrift>& drifts,
                                    double start,
                                    const StartOptions& options)
{
  const std::vector<SpeedDrift> limited = limitedDrifts(drifts, options.max_drift);
  double best = start;
  double best_support = support(limited, start);
  const double least = best_support + options.min_margin;
  for (std::size_t i = 1; i < limited.size(); ++i)
  {
    const double candidate = crossing(limited[i - 1], limited[i]);
    const double candidate_support = support(limited, candidate);
    if (candidate_support > best_support)
    {
      best = candidate;
      best_support = candidate_support;
    }
  }
  if (best_support < least || std::fabs(best - start) < min_difference)
  {
    return std::nullopt;
  }
  return best;
}
}  // namespace dyslam
