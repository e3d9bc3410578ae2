// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dyslam
{
/** A rigid motion in the plane: p -> R(yaw) p + translation. */
struct PlanarMotion
{
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  //!< [m]
  double yaw = 0;                                         //!< [rad]

  [[nodiscard]] Eigen::Vector2d operator*(const Eigen::Vector2d& p) const
  {
    return Eigen::Rotation2Dd(yaw) * p + translation;
  }
  /** Displacement of p [m]. */
  [[nodiscard]] Eigen::Vector2f flowAt(const Eigen::Vector2f& p) const
  {
    return (*this * p.cast<double>()).cast<float>() - p;
  }
  [[nodiscard]] Pose pose() const;
  [[nodiscard]] static PlanarMotion fromPose(const Pose& pose);
};

/** Initial guess of a planar motion. */
struct PlanarPrior
{
  PlanarMotion motion;
  double max_error = 1.5;  //!< largest expected error [m]
};

/** Robust fit of a rigid motion. */
struct RigidFlowFit
{
  PlanarMotion motion;
  std::vector<float> inlier;  //!< robust weight of each flow vector, in [0, 1]
  double rmse = 0;            //!< weighted RMS residual [m]
  double margin = 1;          //!< MotionSearchResult::margin, if all motions were searched
  bool converged = false;     //!< false with fewer than three vectors of positive weight
};

/** Rigid motion of the majority of a flow field: the static flow.
 *
 * Iteratively reweighted least squares in closed form, with a Geman-McClure loss whose width is
 * annealed from `start_width` to `width` (graduated non-convexity), so that outliers with up to
 * half of the weight are rejected.
 *
 * \param positions start points of the flow vectors [m] \param flow flow vectors [m] \param weights
 * weights of the vectors, >= 0 \param width, start_width final and initial width of the loss [m]
 * \param start initial motion, which is also the result if too few vectors determine another; null
 * to start with the weighted least-squares fit.
 */
[[nodiscard]] RigidFlowFit fitRigidFlow(const std::vector<Eigen::Vector2f>& positions,
                                        const std::vector<Eigen::Vector2f>& flow,
                                        const std::vector<float>& weights,
                                        double width = 0.15,
                                        double start_width = 2.0,
                                        const PlanarMotion* start = nullptr);
}  // namespace dyslam
