// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Statistics.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
std::optional<double> ratio(std::size_t part, std::size_t whole)
{
  if (whole == 0)
  {
    return std::nullopt;
  }
  return static_cast<double>(part) / static_cast<double>(whole);
}

Statistics statisticsOf(const std::vector<double>& values)
{
  Statistics result;
  result.count = values.size();
  if (values.empty())
  {
    return result;
  }
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
  {
    throw std::invalid_argument("statisticsOf: non-finite value");
  }
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());
  double sum = 0;
  double squares = 0;
  for (const double v : sorted)
  {
    sum += v;
    squares += v * v;
  }
  result.min = sorted.front();
  result.max = sorted.back();
  result.mean = sum / n;
  result.rmse = std::sqrt(squares / n);
  const std::size_t middle = sorted.size() / 2;
  result.median =
      sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
  double deviations = 0;
  for (const double v : sorted)
  {
    deviations += (v - result.mean) * (v - result.mean);
  }
  result.standard_deviation = std::sqrt(deviations / n);
  return result;
}
}  // namespace dyslam
