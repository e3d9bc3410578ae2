// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace dyslam
{
// Order statistics of n values, without interpolation. Element 0 is the smallest. There must be at
// least one value; the values are reordered.

/** The element with index share * (n - 1), rounded down. \param share in [0, 1] */
template <typename T>
[[nodiscard]] T quantile(std::vector<T>& values, double share)
{
  const auto last = static_cast<double>(values.size() - 1);
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * last);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/** The element with index n / parts, rounded down: one value in `parts` lies below it. */
template <typename Iterator>
[[nodiscard]] auto lowQuantile(Iterator begin, Iterator end, std::size_t parts)
{
  const auto place = begin + (end - begin) / static_cast<std::ptrdiff_t>(parts);
  std::nth_element(begin, place, end);
  return *place;
}

template <typename T>
[[nodiscard]] T lowQuantile(std::vector<T>& values, std::size_t parts)
{
  return lowQuantile(values.begin(), values.end(), parts);
}

/** The median; the upper one for an even number of values. */
template <typename Iterator>
[[nodiscard]] auto upperMedian(Iterator begin, Iterator end)
{
  return lowQuantile(begin, end, 2);
}

template <typename T>
[[nodiscard]] T upperMedian(std::vector<T>& values)
{
  return upperMedian(values.begin(), values.end());
}
}  // namespace dyslam
