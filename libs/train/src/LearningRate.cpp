// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/LearningRate.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
void LearningRateOptions::describe(OptionsVisitor& visitor)
{
  visitor.real("learning_rate", learning_rate, 0, 1,
               "learning rate after the warm-up, before the decay");
  visitor.real("final_rate_ratio", final_rate_ratio, 0, 1,
               "final learning rate, as a fraction of learning_rate");
  visitor.real("decay_start", decay_start, 0, 1,
               "fraction of the steps after which the learning rate decays");
  visitor.integer("warmup_steps", warmup_steps, 1, 1000000,
                  "steps of the linear warm-up of the learning rate");
}

std::int64_t LearningRateOptions::firstOfDecay(std::int64_t steps) const
{
  return static_cast<std::int64_t>(std::ceil(decay_start * static_cast<double>(steps)));
}

double LearningRateOptions::rateAt(std::int64_t step, std::int64_t steps) const
{
  const double rate = learning_rate * std::min(1.0, (static_cast<double>(step) + 1) /
                                                        static_cast<double>(warmup_steps));
  const std::int64_t first = firstOfDecay(steps);
  if (step < first || first >= steps)
  {
    return rate;
  }
  const double done =
      std::min(1.0, static_cast<double>(step - first) / static_cast<double>(steps - first));
  return rate * (final_rate_ratio + (1 - final_rate_ratio) * 0.5 * (1 + std::cos(M_PI * done)));
}
}  // namespace dyslam
