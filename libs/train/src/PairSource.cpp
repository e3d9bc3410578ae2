// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Words.h>
#include <dyslam/train/PairSource.h>
#include <dyslam/train/RandomDraws.h>

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
    appendWord(names, source->name());
  }
  return names;
}

TrainingPair MixedPairSource::pair(std::uint64_t index) const
{
  RandomDraws draws(seed_ ^ 0xA11CEULL, index);
  return sources_[draws.byWeight(weights_)]->pair(index);
}
}  // namespace dyslam
