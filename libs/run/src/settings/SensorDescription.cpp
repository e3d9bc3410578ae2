// SPDX-License-Identifier: BSD-3-Clause
#include "SensorDescription.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Printable.h>

#include <cmath>

namespace dyslam
{
std::string fixed(double value, int decimals)
{
  const double scale = std::pow(10, decimals);
  value = std::abs(value * scale) < 0.5 ? 0 : value;  // not -0.0
  return formatted("%.*f", decimals, value);
}

std::string degrees(double radians, int decimals)
{
  return fixed(degrees_per_radian * radians, decimals);
}

bool turnsFully(const ScanPattern& pattern)
{
  return degrees_per_radian * pattern.azimuth_extent > 359;
}

bool isDenseRevolution(const ScanPattern& pattern)
{
  constexpr std::size_t min_returns = 50000;
  return !pattern.hasRings() && turnsFully(pattern) && pattern.returns >= min_returns;
}

std::string ringsOf(const ScanPattern& pattern)
{
  if (pattern.hasRings())
  {
    return counted(pattern.rings.size(), "ring") + ", " + degrees(pattern.ring_spacing, 1) +
           " deg apart";
  }
  return (isDenseRevolution(pattern) ? "rings not separable (no ring numbers), " : "no rings, ") +
         counted(pattern.returns, "point") + " a scan";
}
}  // namespace dyslam
