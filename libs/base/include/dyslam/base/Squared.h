// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace dyslam
{
[[nodiscard]] constexpr double squared(double x)
{
  return x * x;
}
}  // namespace dyslam
