// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

namespace dyslam
{
/** Position of the satellite receiver's antenna, relative to the pose of the map on the earth.
 *
 * The residual is the error of the position, east, north and up [m], then the east and north
 * components of a unit vector that should be upwards (the map's z axis unless another one is
 * given), and zero. */
class GnssFactor final : public Factor
{
 public:
  static const FactorType factor_type;

  /** \param position measured position of the antenna, east-north-up [m]
   *  \param antenna position of the antenna in the vehicle frame of the keyframe [m]
   *  \param upwards unit vector, map frame
   *  \throws std::invalid_argument for numbers that are not finite. */
  GnssFactor(std::size_t keyframe,
             const Eigen::Vector3d& position,
             const Eigen::Vector3d& antenna,
             const Matrix6& information,
             const Eigen::Vector3d& upwards = Eigen::Vector3d::UnitZ());

  [[nodiscard]] Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const override;
  /** Pose with the measured position and without rotation. */
  [[nodiscard]] Pose measurement() const override;
  [[nodiscard]] FactorLoss loss(const FactorGraphOptions& options) const override;
  [[nodiscard]] FactorData data() const override;
  [[nodiscard]] const Eigen::Vector3d& antenna() const { return antenna_; }

 private:
  Eigen::Vector3d position_;
  Eigen::Vector3d antenna_;
  Eigen::Vector3d upwards_;
};
}  // namespace dyslam
