// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/core/Motion.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <functional>
#include <string>

namespace dyslam
{
/** Normal equations of scalar residuals r(T exp(x)) = r + J' x over the tangent x of a pose T. */
struct NormalEquations
{
  Matrix6 H = Matrix6::Zero();  //!< sum of w J J'
  Vector6 g = Vector6::Zero();  //!< sum of w J r
  double error = 0;             //!< sum of w r^2
  double weight = 0;            //!< sum of w
  std::size_t inliers = 0;      //!< matches, counted by the caller: one may give several rows

  void addRow(const Vector6& J, double r, double w)
  {
    const Vector6 wJ = w * J;
    H.noalias() += wJ * J.transpose();
    g += wJ * r;
    error += w * r * r;
    weight += w;
  }

  /** The row of r = n . (T p - q). \param n unit vector, T's target frame \param p source point
   * \param R rotation of T \param w weight, that of the robust loss included */
  void addRow(const Eigen::Vector3d& n,
              const Eigen::Vector3d& p,
              const Eigen::Matrix3d& R,
              double r,
              double w);

  /** Adds `other` with its weights multiplied by `share`. */
  void add(const NormalEquations& other, double share = 1);
};

/** Weight of a squared residual under the Geman-McClure loss of this width. */
[[nodiscard]] inline double gemanMcClureWeight(double r2, double width)
{
  const double k2 = width * width;
  const double g = k2 / (k2 + r2);
  return g * g;
}

struct PoseGaussNewtonSettings
{
  int max_iterations = 30;
  double start_gate = 1;     //!< largest distance of a match in the first iteration [m]
  double end_gate = 0.2;     //!< lower limit of the gate as it decays [m]
  double gate_decay = 0.75;  //!< factor on the gate per iteration
  std::size_t min_inliers = 30;
  double settled_step = 1e-3;    //!< stop after a smaller step, see motionSize() [m]
  double converged_step = 0.05;  //!< converged if the last step is smaller [m]
};

struct PoseGaussNewtonResult
{
  Pose T = Pose::Identity();
  NormalEquations
      equations;  //!< at the start of the last step; only the count if inliers are too few
  int iterations = 0;
  bool converged = false;
  std::string reason;  //!< why the iteration did not converge; empty if it did
};

/** Adds the rows of the points [begin, end) at pose T, for matches nearer than `gate` [m]. */
using RowMatcher = std::function<void(
    std::size_t begin, std::size_t end, const Pose& T, double gate, NormalEquations& sums)>;

/** Registers `count` points: Gauss-Newton with new matches in every iteration. Directions that no
 * row constrains stay as in T_initial. The result is identical for any number of threads; with
 * several, `match` is called from all of them. */
[[nodiscard]] PoseGaussNewtonResult poseGaussNewton(std::size_t count,
                                                    const RowMatcher& match,
                                                    const Pose& T_initial,
                                                    const PoseGaussNewtonSettings& settings,
                                                    ThreadPool& pool);

/** The result as a motion between scans, with the variance of the residuals as noise.
 * \param points_per_measurement number of points that count as one independent measurement, since
 * residuals of neighbouring points are correlated */
[[nodiscard]] MotionEstimate toMotionEstimate(const PoseGaussNewtonResult& result,
                                              double points_per_measurement);
}  // namespace dyslam
