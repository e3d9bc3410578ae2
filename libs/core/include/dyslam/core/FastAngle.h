// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace dyslam
{
/** atan2(y, x) / 2 pi in (-0.5, 0.5], by an odd polynomial on [0, 1]: fast enough for the azimuth
 * of every point. Abramowitz and Stegun 4.4.49: |error| < 1e-5 rad; 0 for (0, 0). */
[[nodiscard]] inline float turnsOf(float y, float x)
{
  const float ax = std::fabs(x);
  const float ay = std::fabs(y);
  const float high = std::max(ax, ay);
  const float r = std::min(ax, ay) / high;
  const float r2 = r * r;
  constexpr float inverse_two_pi = 0.15915494309189535F;
  float turns =
      inverse_two_pi * r *
      (0.9998660F + r2 * (-0.3302995F + r2 * (0.1801410F + r2 * (-0.0851330F + r2 * 0.0208351F))));
  turns = ay > ax ? 0.25F - turns : turns;
  turns = x < 0 ? 0.5F - turns : turns;
  turns = y < 0 ? -turns : turns;
  return high > 0 ? turns : 0;  // tested last, so that compilers vectorise loops over points
}
}  // namespace dyslam
