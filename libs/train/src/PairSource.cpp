// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/PairSource.h>
#include <dyslam/train/RandomDraws.h>

#include <numeric>

namespace dyslam
{
void MixedPairSource::add(std::unique_ptr<PairSource> source, double weight)
{
  if (weight > 0)
  {
    sources_.push_back(std::move(source));
    weights_.push_back(weight);
  }
}

std::string MixedPairSource::name() const
{
  std::string names;
  for (const auto& source : sources_)
  {
    names += (names.empty() ? "" : ", ") + source->name();
  }
  return names;
}

TrainingPair MixedPairSource::pair(std::uint64_t index) const
{
  RandomDraws draws(seed_ ^ 0xA11CEULL, index);
  double rest = draws.uniform() * std::accumulate(weights_.begin(), weights_.end(), 0.0);
  std::size_t chosen = 0;
  while (chosen + 1 < weights_.size() && rest >= weights_[chosen])
  {
    rest -= weights_[chosen];
    ++chosen;
  }
  return sources_[chosen]->pair(index);
}
}  // namespace dyslam
