// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dyslam
{
/** A rigid motion in the plane: p goes to R(yaw) p + translation. */
struct PlanarMotion
{
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  //!< [m]
  double yaw = 0;                                         //!< [rad]

  [[nodiscard]] Eigen::Vector2d operator*(const Eigen::Vector2d& p) const
  {
    return Eigen::Rotation2Dd(yaw) * p + translation;
  }
  /** Where p goes, less p. */
  [[nodiscard]] Eigen::Vector2f flowAt(const Eigen::Vector2f& p) const
  {
    return (*this * p.cast<double>()).cast<float>() - p;
  }
  [[nodiscard]] Pose pose() const;
  [[nodiscard]] static PlanarMotion fromPose(const Pose& pose);
};

/** A motion known beforehand. */
struct MotionGuess
{
  PlanarMotion motion;
  double within = 1.5;  //!< how far off it may be [m]
};

struct RigidFlowFit
{
  PlanarMotion motion;
  std::vector<float> inlier;  //!< robust weight of each vector in [0, 1]
  double rmse = 0;            //!< of the weighted residuals [m]
  double lead = 1;            //!< over other motions, where all were looked at: MotionVote
  bool converged = false;     //!< false with fewer than three vectors of any weight
};

/** The rigid motion that best explains most of a flow field: the static flow.
 *
 * Weighted least squares in closed form, reweighted with a Geman-McClure kernel whose width shrinks
 * from `start_width` to `width`, so that movers lose their say whatever their number, up to half of
 * the weight.
 *
 * \param places starts of the flow vectors [m] \param flow the vectors [m] \param weights >= 0
 * \param start an optional first motion; without it the plain weighted fit starts.
 */
[[nodiscard]] RigidFlowFit fitRigidFlow(const std::vector<Eigen::Vector2f>& places,
                                        const std::vector<Eigen::Vector2f>& flow,
                                        const std::vector<float>& weights,
                                        double width = 0.15,
                                        double start_width = 2.0,
                                        const PlanarMotion* start = nullptr);
}  // namespace dyslam
