// SPDX-License-Identifier: BSD-3-Clause
#include "RegistrationQuality.h"

#include <dyslam/base/Printable.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr std::size_t min_inliers = 50;
/** Rotation weighs as the translation that it causes at this distance [m]. */
constexpr double lever = 10;
}  // namespace

std::string failureReason(const ScanToMapResult& found, const RefineOptions& options)
{
  if (!found.finite)
  {
    return "the registration has no finite solution";
  }
  if (found.surface_share < options.min_surface_share)
  {
    return formatted(
        "%.0f %% of the points have a surface in the local map, the limit is %g %% "
        "(refine.min_surface_share): the map's cells are too small for the sensor, raise "
        "refine.levels or refine.cell_size",
        std::floor(100 * found.surface_share), 100 * options.min_surface_share);
  }
  if (found.inliers < min_inliers)
  {
    return formatted("the scan does not fit the local map: %zu inlier%s, the limit is %zu",
                     found.inliers, found.inliers == 1 ? "" : "s", min_inliers);
  }
  if (found.inlier_ratio < options.min_inlier_ratio)
  {
    return formatted(
        "the scan does not fit the local map: inlier ratio %.2f, the limit is %g "
        "(refine.min_inlier_ratio)",
        std::floor(100 * found.inlier_ratio) / 100, options.min_inlier_ratio);
  }
  return {};
}

bool isDegenerate(const Matrix6& information, double sigma)
{
  Matrix6 scaled = information;
  scaled.bottomRows<3>() /= lever;
  scaled.rightCols<3>() /= lever;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] < 1 / (sigma * sigma);
}

double poseDistance(const Pose& a, const Pose& b)
{
  const Pose T = a.inverse() * b;
  return T.translation().norm() + lever * rotationAngle(T);
}
}  // namespace dyslam
