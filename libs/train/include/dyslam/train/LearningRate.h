// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <cstdint>

namespace dyslam
{
/** Schedule of the learning rate: linear warm-up, constant, then cosine decay. Until `decay_start`
 * it does not depend on the number of steps, so that a training can be extended from there. */
struct LearningRateOptions : Options
{
  double learning_rate = 1e-3;
  double final_rate_ratio = 0.02;  //!< final rate as a fraction of `learning_rate`
  double decay_start = 0.5;        //!< fraction of the steps after which the rate decays
  int warmup_steps = 100;          //!< steps of the linear warm-up

  void describe(OptionsVisitor& visitor) override;

  /** Rate of a step, counted from 0. */
  [[nodiscard]] double rateAt(std::int64_t step, std::int64_t steps) const;
  /** First step at which the rate decays. \param steps number of all steps */
  [[nodiscard]] std::int64_t firstOfDecay(std::int64_t steps) const;
};
}  // namespace dyslam
