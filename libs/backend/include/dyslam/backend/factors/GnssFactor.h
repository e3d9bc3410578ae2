// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

namespace dyslam
{
/** A position of the satellite receiver's antenna, relative to the pose of the map on the earth.
 *
 * The residual is the distance from the position, east, north and up [m], then how far the map's z
 * axis leans to the east and to the north (as a unit vector), and zero. */
class GnssFactor final : public Factor
{
 public:
  /** \param position of the antenna, east-north-up [m]
   *  \param antenna in the vehicle frame of the keyframe [m]
   *  \throws std::invalid_argument for numbers that are not finite. */
  GnssFactor(std::size_t keyframe,
             const Eigen::Vector3d& position,
             const Eigen::Vector3d& antenna,
             const Matrix6& information);

  [[nodiscard]] FactorKind kind() const override { return FactorKind::gnss; }
  [[nodiscard]] Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const override;
  /** The position, without rotation. */
  [[nodiscard]] Pose measurement() const override;
  [[nodiscard]] const Eigen::Vector3d& antenna() const { return antenna_; }

 private:
  Eigen::Vector3d position_;
  Eigen::Vector3d antenna_;
};
}  // namespace dyslam
