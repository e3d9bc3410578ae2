// SPDX-License-Identifier: BSD-3-Clause
#include "LengthFindings.h"

#include <dyslam/base/Quantile.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace dyslam
{
namespace
{
/** Median range of the points, without those at the origin and those that are no numbers [m]; 0
 * without any. */
float medianRange(const Scan& scan)
{
  std::vector<float> ranges;
  ranges.reserve(scan.size());
  for (const Eigen::Vector3f& point : scan.points)
  {
    if (const float range = point.stableNorm(); range > 0 && std::isfinite(range))
    {
      ranges.push_back(range);
    }
  }
  return ranges.empty() ? 0 : upperMedian(ranges);
}

/** Share of the points, without those at the origin, whose coordinates are all whole numbers; 0 of
 * few points. */
double shareOfWholeNumbers(const Scan& scan)
{
  constexpr std::size_t few = 1000;
  std::size_t points = 0;
  std::size_t whole = 0;
  for (const Eigen::Vector3f& point : scan.points)
  {
    if (point.allFinite() && !point.isZero(0))
    {
      ++points;
      whole += point.array().round().matrix() == point ? 1 : 0;
    }
  }
  return points < few ? 0 : static_cast<double>(whole) / static_cast<double>(points);
}
}  // namespace

LengthFindings lengthsOf(const Scan& scan)
{
  return {medianRange(scan), shareOfWholeNumbers(scan)};
}

bool LengthFindings::areTooFar() const
{
  constexpr float farthest = 1e5F;  // [m]
  return median_range > farthest;
}

/** Distances alone do not show centimetres: those of a lidar on a drone are as large in metres. */
std::string LengthFindings::warning(double scale) const
{
  const std::string millimetres = "millimetres (--scale 0.001)";
  const std::string or_centimetres = " or in centimetres (--scale 0.01)";
  constexpr float implausible = 1000;               // [m]
  constexpr float implausible_centimetres = 10000;  // [cm]
  if (median_range > implausible)
  {
    return "half of its points are more than " + std::to_string(std::lround(median_range)) +
           " m away: its coordinates are probably in " + millimetres +
           (median_range < implausible_centimetres ? or_centimetres : "");
  }
  constexpr double nearly_all = 0.99;
  return scale == 1 && whole_numbers > nearly_all
             ? "its coordinates are whole numbers: they are probably in " + millimetres +
                   or_centimetres
             : "";
}
}  // namespace dyslam
