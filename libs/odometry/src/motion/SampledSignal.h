// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

namespace dyslam
{
template <typename Value>
struct Sample
{
  double stamp = 0;  //!< UNIX time [s]
  Value value{};
};

/** A signal over an interval: linear between its samples, constant before the first and after the
 * last. */
template <typename Value>
class SampledSignal
{
 public:
  /** \param samples ascending by stamp; must outlive the object \param max_gap largest time without
   * a sample, also at the ends of the interval [s] */
  SampledSignal(const std::deque<Sample<Value>>& samples, double begin, double end, double max_gap)
      : begin_(begin), end_(end)
  {
    auto sample = std::upper_bound(samples.begin(), samples.end(), begin,
                                   [](double t, const auto& other) { return t < other.stamp; });
    sample -= sample == samples.begin() ? 0 : 1;
    if (sample == samples.end() || sample->stamp - begin > max_gap)
    {
      return;
    }
    do
    {
      used_.push_back(&*sample);
      ++sample;
    } while (last() < end && sample != samples.end() && sample->stamp - last() <= max_gap);
    complete_ = end - last() <= max_gap;
  }

  [[nodiscard]] bool isComplete() const { return complete_; }

  /** \pre isComplete() */
  [[nodiscard]] Value at(double t) const
  {
    const auto after =
        std::lower_bound(used_.begin(), used_.end(), t,
                         [](const auto* sample, double time) { return sample->stamp < time; });
    if (after == used_.begin() || after == used_.end())
    {
      return after == used_.end() ? used_.back()->value : used_.front()->value;
    }
    const Sample<Value>& a = **(after - 1);
    const Sample<Value>& b = **after;
    return a.value + (t - a.stamp) / (b.stamp - a.stamp) * (b.value - a.value);
  }

  /** Largest error of the mean over the interval, if the signal changes by at most `rate` per
   * second in the parts where it is extrapolated as constant. \pre isComplete() */
  [[nodiscard]] double heldError(double rate) const
  {
    return rate * (heldMean(used_.front()->stamp - begin_) + heldMean(end_ - last()));
  }

  void addStampsWithin(std::vector<double>& stamps) const
  {
    for (const Sample<Value>* sample : used_)
    {
      if (sample->stamp > begin_ && sample->stamp < end_)
      {
        stamps.push_back(sample->stamp);
      }
    }
  }

 private:
  [[nodiscard]] double last() const { return used_.back()->stamp; }

  /** Mean over the interval of the time since a value at one end that is held for `held` seconds.
   */
  [[nodiscard]] double heldMean(double held) const
  {
    const double span = end_ - begin_;
    return held <= 0 || span <= 0 ? 0 : held < span ? 0.5 * held * held / span : held - 0.5 * span;
  }

  double begin_;
  double end_;
  std::vector<const Sample<Value>*> used_;
  bool complete_ = false;
};
}  // namespace dyslam
