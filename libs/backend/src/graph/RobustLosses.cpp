// SPDX-License-Identifier: BSD-3-Clause
#include "RobustLosses.h"

namespace dyslam
{
namespace
{
class DcsLoss final : public ceres::LossFunction
{
 public:
  explicit DcsLoss(double width) : phi_(width * width) {}

  void Evaluate(double s, double rho[3]) const override
  {
    if (s <= phi_)
    {
      rho[0] = s;
      rho[1] = 1;
      rho[2] = 0;
      return;
    }
    const double sum = phi_ + s;
    rho[0] = 3 * phi_ - 4 * phi_ * phi_ / sum;
    rho[1] = 4 * phi_ * phi_ / (sum * sum);
    rho[2] = -2 * rho[1] / sum;
  }

 private:
  double phi_;
};
}  // namespace

std::unique_ptr<ceres::LossFunction> makeDcsLoss(double width)
{
  return std::make_unique<DcsLoss>(width);
}

std::unique_ptr<ceres::LossFunction> makeLoss(RobustLoss loss, double width)
{
  switch (loss)
  {
    case RobustLoss::cauchy:
      return std::make_unique<ceres::CauchyLoss>(width);
    case RobustLoss::dcs:
      return makeDcsLoss(width);
    case RobustLoss::none:
      break;
  }
  return nullptr;
}
}  // namespace dyslam
