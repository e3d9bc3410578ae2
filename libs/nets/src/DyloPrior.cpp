// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloPrior.h>

#include <Eigen/Cholesky>

namespace dyslam
{
namespace
{
/** Standard deviation due to the sensor and to non-planar surfaces [m]. */
constexpr double min_sigma = 0.01;
}  // namespace

double measurementPrecision(double rmse, double effective_points, double points_per_measurement)
{
  return effective_points / points_per_measurement / (rmse * rmse + min_sigma * min_sigma);
}

Vector6 fuseWithPrior(const DyloPrior& prior,
                      const Pose& T,
                      const Vector6& step,
                      const Matrix6& measured)
{
  const Matrix6 to_right = adjointSE3(T.inverse());
  const Matrix6 prior_information = to_right.transpose() * prior.information * to_right;
  const Vector6 to_prior = logSE3(prior.T_reference_current * T.inverse());
  const Matrix6 total = measured + prior_information;
  return total.ldlt().solve(measured * step + prior_information * to_prior);
}
}  // namespace dyslam
