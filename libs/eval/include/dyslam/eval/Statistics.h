// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace dyslam
{
/** The usual summary of a set of errors. All zero, with count 0, for an empty set. */
struct Statistics
{
  std::size_t count = 0;
  double max = 0;
  double mean = 0;
  double median = 0;  //!< mean of the two middle values where the count is even
  double min = 0;
  double rmse = 0;
  double standard_deviation = 0;  //!< of the population (divided by count)
};

/** \throws std::invalid_argument for a value that is not finite. */
[[nodiscard]] Statistics statisticsOf(const std::vector<double>& values);
}  // namespace dyslam
