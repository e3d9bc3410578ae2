// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

namespace dyslam
{
/** Ini section `[loss]` of DySeg's training. */
struct DysegLossOptions : Options
{
  int iterations = 2;          //!< flow updates in training
  double decay = 0.8;          //!< weight of an update's flow relative to the next one's
  int points = 3072;           //!< number of points sampled per pair for the point loss
  double first_noise = 0.35;   //!< sigma of TeacherMotions::coarse [m]; of its yaw: 1.5 deg per m
  double second_noise = 0.06;  //!< sigma of TeacherMotions::fine [m]
  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
