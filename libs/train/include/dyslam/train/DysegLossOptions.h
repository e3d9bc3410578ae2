// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

namespace dyslam
{
struct DysegLossOptions : Options
{
  int iterations = 2;          //!< flow updates in training
  double decay = 0.8;          //!< weight of an update's flow relative to the next one's
  int points = 3072;           //!< of a pair in the point loss
  double first_noise = 0.35;   //!< m, error of the guide at 1/4 resolution; its yaw 1.5 deg per m
  double second_noise = 0.06;  //!< m, error of the static flow in training
  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
