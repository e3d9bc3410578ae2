// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

namespace dyslam
{
constexpr double millimetre = 1e-3;

/** To a decimal step, as a number that is printed short; null where it is not finite. */
[[nodiscard]] nlohmann::ordered_json rounded(double value, double step);
[[nodiscard]] nlohmann::ordered_json rounded(const std::vector<double>& values, double step);
[[nodiscard]] nlohmann::ordered_json rounded(const Eigen::Vector3d& v, double step);

/** Every how many entries one is shown, so that at most `most` are. */
[[nodiscard]] std::size_t stepFor(std::size_t count, std::size_t most);

template <typename Values>
[[nodiscard]] Values everyNth(const Values& values, std::size_t step)
{
  Values result;
  for (std::size_t i = 0; i < values.size(); i += step)
  {
    result.push_back(values[i]);
  }
  return result;
}
[[nodiscard]] Trajectory everyNth(const Trajectory& trajectory, std::size_t step);
}  // namespace dyslam
