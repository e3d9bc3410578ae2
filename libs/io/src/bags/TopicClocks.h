// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Quantile.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace dyslam
{
/** Compares the clocks of a bag's topics by the times of recording, which are of one clock. */
class TopicClocks
{
 public:
  /** A message. \param stamp of its header [s] \param recorded time of recording [s] */
  void add(std::size_t topic, double stamp, double recorded)
  {
    constexpr std::size_t enough = 100;
    std::vector<double>& delays = delays_[topic];
    if (delays.size() < enough)
    {
      delays.push_back(recorded - stamp);
    }
  }

  /** How much later the stamps of a topic are than those of another [s]; nothing if either has few
   * messages, or was not recorded at a constant delay. */
  [[nodiscard]] std::optional<double> offset(std::size_t topic, std::size_t other) const
  {
    const std::optional<double> of_topic = delayOf(topic);
    const std::optional<double> of_other = delayOf(other);
    return of_topic && of_other ? std::optional(*of_other - *of_topic) : std::nullopt;
  }

 private:
  [[nodiscard]] std::optional<double> delayOf(std::size_t topic) const
  {
    constexpr std::size_t fewest = 10;
    constexpr double largest_change = 0.3;  // [s]
    const auto found = delays_.find(topic);
    if (found == delays_.end() || found->second.size() < fewest)
    {
      return std::nullopt;
    }
    std::vector<double> sorted = found->second;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t tenth = sorted.size() / 10;
    const bool is_constant = sorted[sorted.size() - 1 - tenth] - sorted[tenth] < largest_change;
    return is_constant ? std::optional(upperMedian(sorted)) : std::nullopt;
  }

  std::map<std::size_t, std::vector<double>> delays_;  //!< of the first messages, by topic [s]
};
}  // namespace dyslam
