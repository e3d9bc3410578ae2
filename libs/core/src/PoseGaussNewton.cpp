// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PoseGaussNewton.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace dyslam
{
namespace
{
constexpr std::size_t chunk_size = 256;
constexpr double range_noise = 0.015;  // sigma of a range, added to the residuals' [m]
}  // namespace

void NormalEquations::addRow(const Eigen::Vector3d& n,
                             const Eigen::Vector3d& p,
                             const Eigen::Matrix3d& R,
                             double r,
                             double w)
{
  const Eigen::Vector3d nb = R.transpose() * n;
  Vector6 J;
  J.head<3>() = nb;
  J.tail<3>() = p.cross(nb);
  addRow(J, r, w);
}

void NormalEquations::add(const NormalEquations& other, double share)
{
  H += share * other.H;
  g += share * other.g;
  error += share * other.error;
  weight += share * other.weight;
  inliers += other.inliers;
}

PoseGaussNewtonResult poseGaussNewton(std::size_t count,
                                      const RowMatcher& match,
                                      const Pose& T_initial,
                                      const PoseGaussNewtonSettings& settings,
                                      ThreadPool& pool)
{
  PoseGaussNewtonResult result;
  result.T = T_initial;
  double gate = std::max(settings.start_gate, settings.end_gate);
  std::vector<NormalEquations> parts(ThreadPool::chunkCount(count, chunk_size));
  double last_step = 1;
  while (result.iterations < settings.max_iterations)
  {
    pool.forChunks(count, chunk_size,
                   [&](std::size_t begin, std::size_t end, std::size_t chunk)
                   {
                     parts[chunk] = NormalEquations();
                     match(begin, end, result.T, gate, parts[chunk]);
                   });
    NormalEquations sums;
    for (const NormalEquations& part : parts)
    {
      sums.add(part);
    }
    ++result.iterations;
    if (sums.inliers < settings.min_inliers)
    {
      result.equations = NormalEquations();
      result.equations.inliers = sums.inliers;
      result.reason =
          "only " + std::to_string(sums.inliers) + (sums.inliers == 1 ? " match" : " matches");
      return result;
    }
    result.equations = sums;
    const double damping = 1e-6 * sums.H.diagonal().maxCoeff();
    const Vector6 step = -(sums.H + damping * Matrix6::Identity()).ldlt().solve(sums.g);
    if (!step.allFinite())
    {
      result.reason = "the normal equations have no solution";
      return result;
    }
    result.T = orthonormalised(result.T * expSE3(step));
    last_step = motionSize(step);
    if (gate <= settings.end_gate && last_step < settings.settled_step)
    {
      break;
    }
    gate = std::max(settings.end_gate, settings.gate_decay * gate);
  }
  result.converged = last_step < settings.converged_step;
  if (!result.converged)
  {
    result.reason = "the registration did not converge";
  }
  return result;
}

MotionEstimate toMotionEstimate(const PoseGaussNewtonResult& result, double points_per_measurement)
{
  const NormalEquations& equations = result.equations;
  const double variance = equations.error / std::max(equations.weight, 1e-12);
  MotionEstimate estimate;
  estimate.T_previous_current = result.T;
  estimate.information = equations.H / ((variance + range_noise * range_noise) *
                                        std::max(1.0, points_per_measurement));
  estimate.status = result.converged ? MotionStatus::converged : MotionStatus::not_found;
  estimate.iterations = result.iterations;
  estimate.inliers = equations.inliers;
  estimate.rmse = std::sqrt(variance);
  estimate.reason = result.reason;
  return estimate;
}
}  // namespace dyslam
