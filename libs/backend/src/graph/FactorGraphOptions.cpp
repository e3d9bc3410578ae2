// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphOptions.h>

namespace dyslam
{
void FactorGraphOptions::describe(OptionsVisitor& visitor)
{
  visitor.integer("max_iterations", max_iterations, 0, 10000,
                  "upper limit of the solver's iterations");
  visitor.real("tolerance", tolerance, 0, 1,
               "relative decrease of the cost in a step below which the solver stops");
  visitor.choice(
      "loop_loss", loop_loss,
      {{"none", RobustLoss::none}, {"cauchy", RobustLoss::cauchy}, {"dcs", RobustLoss::dcs}},
      "robust loss of loop factors");
  visitor.real("loop_loss_width", loop_loss_width, 1e-6, 1e6,
               "width of the robust loss of loop factors, as a whitened residual [sigmas]");
  visitor.real("odometry_sigma_scale", odometry_sigma_scale, 1, 1000,
               "factor on the odometry's sigmas where loops are checked against the odometry");
  visitor.choice(
      "object_loss", object_loss,
      {{"none", RobustLoss::none}, {"cauchy", RobustLoss::cauchy}, {"dcs", RobustLoss::dcs}},
      "robust loss of object observation factors");
  visitor.real(
      "object_loss_width", object_loss_width, 1e-6, 1e6,
      "width of the robust loss of object observation factors, as a whitened residual [sigmas]");
  visitor.choice(
      "gnss_loss", gnss_loss,
      {{"none", RobustLoss::none}, {"cauchy", RobustLoss::cauchy}, {"dcs", RobustLoss::dcs}},
      "robust loss of positions of a satellite receiver");
  visitor.real("gnss_loss_width", gnss_loss_width, 1e-6, 1e6,
               "width of the robust loss of positions of a satellite receiver, as a whitened "
               "residual [sigmas]");
}
}  // namespace dyslam
