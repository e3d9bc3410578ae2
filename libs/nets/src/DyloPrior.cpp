// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloPrior.h>

#include <Eigen/Cholesky>

namespace dyslam
{
namespace
{
/** Of the sensor and of surfaces that are not as flat as they look [m]. */
constexpr double least_sigma = 0.01;
}  // namespace

double measuredPrecision(double rmse, double effective_points, double correlated_points)
{
  return effective_points / correlated_points / (rmse * rmse + least_sigma * least_sigma);
}

Vector6 jointStep(const DyloPrior& prior,
                  const Pose& T,
                  const Vector6& step,
                  const Matrix6& measured)
{
  const Matrix6 to_right = adjointSE3(T.inverse());
  const Matrix6 expected = to_right.transpose() * prior.information * to_right;
  const Vector6 to_prior = logSE3(prior.T_reference_current * T.inverse());
  const Matrix6 both = measured + expected;
  return both.ldlt().solve(measured * step + expected * to_prior);
}
}  // namespace dyslam
