// SPDX-License-Identifier: BSD-3-Clause
#include "NoiseScale.h"

#include <dyslam/base/StateArchive.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace dyslam
{
std::optional<double> whiteNoise(const PositionHistory& history, const Eigen::Matrix2d& covariance)
{
  constexpr double max_jitter = 0.02;  // largest relative difference of the intervals
  if (history.size() < 4)
  {
    return std::nullopt;
  }
  const auto last = history.end() - 4;
  const double interval = (last[3].stamp - last[0].stamp) / 3;
  for (int i = 0; i < 3; ++i)
  {
    if (std::abs(last[i + 1].stamp - last[i].stamp - interval) > max_jitter * interval)
    {
      return std::nullopt;
    }
  }
  const Eigen::Vector2d difference =
      last[3].position - 3 * last[2].position + 3 * last[1].position - last[0].position;
  // The covariance of the difference is 1 + 9 + 9 + 1 times that of the noise; the mean length of a
  // standard normal vector in the plane is sqrt(pi / 2).
  const double length = std::sqrt(difference.dot(covariance.llt().solve(difference)) / 20);
  return length / std::sqrt(M_PI / 2);
}

void NoiseScale::add(double white_noise)
{
  constexpr double forgetting_factor = 0.998;
  sum_ = forgetting_factor * sum_ + white_noise;
  weight_ = forgetting_factor * weight_ + 1;
}

double NoiseScale::factor() const
{
  return std::clamp(sum_ / weight_, 1.0, 10.0);
}

void NoiseScale::exchangeState(StateArchive& archive)
{
  archive(sum_, weight_);
}
}  // namespace dyslam
