// SPDX-License-Identifier: BSD-3-Clause
#include "IntensityScaler.h"

#include <algorithm>
#include <cmath>

namespace dyslam
{
void IntensityScaler::operator()(Scan& scan)
{
  constexpr float above_one = 2;  // 1.002 is rounding
  const auto bright = [](float value) { return std::isfinite(value) && value > above_one; };
  if (scale_ == 0 && std::any_of(scan.intensity.begin(), scan.intensity.end(), bright))
  {
    scale_ = 1.0 / 255.0;
    by_data_ = true;
  }
  if (scale_ == 0 || scale_ == 1.0)
  {
    return;
  }
  for (float& value : scan.intensity)
  {
    value *= static_cast<float>(scale_);
    value = by_data_ ? std::min(value, 1.0F) : value;
  }
}
}  // namespace dyslam
