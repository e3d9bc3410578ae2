// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectMotionEvidence.h"

#include <algorithm>
#include <cmath>

namespace dyslam
{
SpeedEstimate fitSpeed(const std::vector<PlanarObservation>& observations)
{
  const auto n = static_cast<double>(observations.size());
  const double start = observations.front().time;
  double mean_time = 0;
  double variance = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const PlanarObservation& observation : observations)
  {
    mean_time += (observation.time - start) / n;
    mean += observation.position / n;
    variance += observation.sigma * observation.sigma / n;
  }
  mean_time += start;
  double spread = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (const PlanarObservation& observation : observations)
  {
    const double t = observation.time - mean_time;
    spread += t * t;
    moment += t * (observation.position - mean);
  }
  SpeedEstimate result;
  result.velocity = moment / spread;
  double scatter = 0;
  for (const PlanarObservation& observation : observations)
  {
    const Eigen::Vector2d expected = mean + result.velocity * (observation.time - mean_time);
    scatter += (observation.position - expected).squaredNorm();
  }
  scatter /= 2 * std::max(1.0, n - 2);
  result.sigma = std::sqrt(std::max(variance, scatter) / spread);
  return result;
}
}  // namespace dyslam
