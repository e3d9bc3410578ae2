// SPDX-License-Identifier: BSD-3-Clause
#include "RowAlignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace dyslam
{
namespace
{
constexpr std::size_t chunk_size = 256;
constexpr double kernel_decay = 0.75;
constexpr double sensor_sigma = 0.015;
}  // namespace

void RowSums::addRow(const Eigen::Vector3d& n,
                     const Eigen::Vector3d& p,
                     const Eigen::Matrix3d& R,
                     double r,
                     double w)
{
  const Eigen::Vector3d nb = R.transpose() * n;
  Vector6 J;
  J.head<3>() = nb;
  J.tail<3>() = p.cross(nb);
  const Vector6 wJ = w * J;
  H.noalias() += wJ * J.transpose();
  g += wJ * r;
  error += w * r * r;
  weight += w;
}

void RowSums::add(const RowSums& other)
{
  H += other.H;
  g += other.g;
  error += other.error;
  weight += other.weight;
  inliers += other.inliers;
}

MotionEstimate alignByRows(std::size_t count,
                           const RowMatcher& match,
                           const Pose& T_guess,
                           const RowAlignmentSettings& settings,
                           ThreadPool& pool)
{
  MotionEstimate estimate;
  Pose T = T_guess;
  double gate = std::max(settings.start_kernel, settings.kernel);
  std::vector<RowSums> parts(ThreadPool::chunkCount(count, chunk_size));
  double last_step = 1;
  while (estimate.iterations < settings.max_iterations)
  {
    pool.forChunks(count, chunk_size,
                   [&](std::size_t begin, std::size_t end, std::size_t chunk)
                   {
                     parts[chunk] = RowSums();
                     match(begin, end, T, gate, parts[chunk]);
                   });
    RowSums sums;
    for (const RowSums& part : parts)
    {
      sums.add(part);
    }
    ++estimate.iterations;
    estimate.inliers = sums.inliers;
    if (sums.inliers < settings.fewest_inliers)
    {
      estimate.information.setZero();
      estimate.reason = "only " + std::to_string(sums.inliers) + " matches";
      return estimate;
    }
    const double variance = sums.error / std::max(sums.weight, 1e-12);
    estimate.rmse = std::sqrt(variance);
    estimate.information = sums.H / ((variance + sensor_sigma * sensor_sigma) *
                                     std::max(1.0, settings.correlated_points));
    // Directions that no row fixes stay as guessed.
    const double damping = 1e-6 * sums.H.diagonal().maxCoeff();
    const Vector6 step = -(sums.H + damping * Matrix6::Identity()).ldlt().solve(sums.g);
    if (!step.allFinite())
    {
      estimate.reason = "the normal equations have no solution";
      return estimate;
    }
    T = orthonormalized(T * expSE3(step));
    last_step = motionSize(step);
    if (gate <= settings.kernel && last_step < 1e-3)
    {
      break;
    }
    gate = std::max(settings.kernel, kernel_decay * gate);
  }
  estimate.T_previous_current = T;
  estimate.converged = last_step < 0.05;
  if (!estimate.converged)
  {
    estimate.reason = "the registration did not settle";
  }
  return estimate;
}
}  // namespace dyslam
