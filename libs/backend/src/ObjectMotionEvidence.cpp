// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectMotionEvidence.h"

#include <algorithm>
#include <cmath>

namespace dyslam
{
SpeedEstimate fitSpeed(const std::vector<PlanarObservation>& observations,
                       std::size_t first,
                       std::size_t last)
{
  const auto n = static_cast<double>(last - first);
  double mean_time = 0;
  double variance = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t i = first; i < last; ++i)
  {
    mean_time += (observations[i].time - observations[first].time) / n;
    mean += observations[i].position / n;
    variance += observations[i].sigma * observations[i].sigma / n;
  }
  mean_time += observations[first].time;
  double spread = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (std::size_t i = first; i < last; ++i)
  {
    const double t = observations[i].time - mean_time;
    spread += t * t;
    moment += t * (observations[i].position - mean);
  }
  SpeedEstimate result;
  result.velocity = moment / spread;
  double scatter = 0;
  for (std::size_t i = first; i < last; ++i)
  {
    const Eigen::Vector2d expected = mean + result.velocity * (observations[i].time - mean_time);
    scatter += (observations[i].position - expected).squaredNorm();
  }
  scatter /= 2 * std::max(1.0, n - 2);
  result.sigma = std::sqrt(std::max(variance, scatter) / spread);
  return result;
}
}  // namespace dyslam
