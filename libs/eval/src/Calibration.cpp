// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Labels.h>
#include <dyslam/eval/Calibration.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
void CalibrationEvaluator::add(const std::vector<std::uint32_t>& reference,
                               const std::vector<float>& probability)
{
  if (reference.size() != probability.size())
  {
    throw std::invalid_argument("CalibrationEvaluator: labels and probabilities differ in number");
  }
  for (std::size_t i = 0; i < reference.size(); ++i)
  {
    if (isIgnoredLabel(reference[i]) || !std::isfinite(probability[i]))
    {
      continue;
    }
    const double p = std::clamp(static_cast<double>(probability[i]), 0.0, 1.0);
    const bool moving = isMovingLabel(reference[i]);
    Sums& sums = sums_[std::min(bin_count - 1, static_cast<std::size_t>(p * bin_count))];
    ++sums.points;
    sums.moving += moving ? 1 : 0;
    sums.probability += p;
    ++points_;
    squares_ += (p - (moving ? 1 : 0)) * (p - (moving ? 1 : 0));
  }
}

std::vector<CalibrationEvaluator::Bin> CalibrationEvaluator::bins() const
{
  std::vector<Bin> result;
  for (std::size_t i = 0; i < bin_count; ++i)
  {
    const Sums& sums = sums_[i];
    const auto points = static_cast<double>(std::max<std::size_t>(1, sums.points));
    result.push_back({static_cast<double>(i) / bin_count, static_cast<double>(i + 1) / bin_count,
                      sums.points, sums.probability / points,
                      static_cast<double>(sums.moving) / points});
  }
  return result;
}

double CalibrationEvaluator::expectedError() const
{
  double sum = 0;
  for (const Bin& bin : bins())
  {
    sum += static_cast<double>(bin.points) * std::abs(bin.probability - bin.moving);
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, points_));
}

double CalibrationEvaluator::brierScore() const
{
  return squares_ / static_cast<double>(std::max<std::size_t>(1, points_));
}
}  // namespace dyslam
