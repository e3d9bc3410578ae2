// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace dyslam
{
/** Summary statistics of a set of errors, in their unit. All zero for an empty set. */
struct Statistics
{
  std::size_t count = 0;
  double max = 0;
  double mean = 0;
  double median = 0;  //!< mean of the two middle values if the count is even
  double min = 0;
  double rmse = 0;
  double standard_deviation = 0;  //!< of the population (divided by count)
};

/** Statistics of `values`. \throws std::invalid_argument for a non-finite value. */
[[nodiscard]] Statistics statisticsOf(const std::vector<double>& values);

/** part / whole; nothing for an empty whole. */
[[nodiscard]] std::optional<double> ratio(std::size_t part, std::size_t whole);
}  // namespace dyslam
