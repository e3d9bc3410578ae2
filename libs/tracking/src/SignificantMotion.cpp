// SPDX-License-Identifier: BSD-3-Clause
#include "SignificantMotion.h"

#include <algorithm>
#include <cmath>

namespace dyslam
{
bool hasSignificantMotion(const PositionHistory& history)
{
  constexpr double min_speed = 0.5;     // least speed of the line [m/s]
  constexpr double min_distance = 0.4;  // least distance travelled along the line [m]
  constexpr double sigmas = 8;
  constexpr std::size_t min_count = 4;
  constexpr double prior_sigma = 0.05;  // prior sigma of one observation [m]
  constexpr std::size_t usual_count = 12;
  constexpr double usual_duration = 1.1;  // at 10 Hz; of faster scans more observations count [s]
  std::size_t count = std::min(usual_count, history.size());
  while (count < history.size() &&
         history.back().stamp - history[history.size() - count - 1].stamp <= usual_duration)
  {
    ++count;
  }
  if (count < min_count)
  {
    return false;
  }
  const auto first = history.end() - static_cast<std::ptrdiff_t>(count);
  const double n = static_cast<double>(count);
  double mean_time = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (auto it = first; it != history.end(); ++it)
  {
    mean_time += it->stamp / n;
    mean += it->position / n;
  }
  double time_spread = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (auto it = first; it != history.end(); ++it)
  {
    time_spread += (it->stamp - mean_time) * (it->stamp - mean_time);
    slope += (it->stamp - mean_time) * (it->position - mean);
  }
  slope /= time_spread;
  double squared_residuals = 2 * prior_sigma * prior_sigma;
  for (auto it = first; it != history.end(); ++it)
  {
    squared_residuals += (it->position - mean - (it->stamp - mean_time) * slope).squaredNorm();
  }
  const double sigma = std::sqrt(squared_residuals / (2 * (n - 2) + 2) / time_spread);
  const double distance = slope.norm() * (history.back().stamp - first->stamp);
  return slope.norm() > min_speed && distance > min_distance && slope.norm() > sigmas * sigma;
}
}  // namespace dyslam
