// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

namespace dyslam
{
/** Robust loss as a function of the squared whitened residual. */
enum class RobustLoss
{
  none,
  cauchy,  //!< logarithmic beyond the width
  dcs,     //!< dynamic covariance scaling: a switchable constraint with the switch solved for
};

struct FactorGraphOptions : Options
{
  int max_iterations = 50;
  double tolerance = 1e-6;  //!< stop when a step lowers the cost by less than this fraction
  RobustLoss loop_loss = RobustLoss::dcs;  //!< robust loss of loop factors
  double loop_loss_width = 3;              //!< width of loop_loss, as a whitened residual
  /** Factor on the odometry's sigmas when loops are checked against the odometry. */
  double odometry_sigma_scale = 3;
  RobustLoss object_loss = RobustLoss::cauchy;  //!< robust loss of observation factors
  double object_loss_width = 3;                 //!< width of object_loss, as a whitened residual
  RobustLoss gnss_loss = RobustLoss::cauchy;    //!< robust loss of satellite positions
  double gnss_loss_width = 2;                   //!< width of gnss_loss, as a whitened residual

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
