// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>

namespace dyslam
{
/** Gravity at a keyframe by an accelerometer, relative to the vertical in the map frame and to the
 * accelerometer's bias.
 *
 * The residual is the horizontal part of the measured gravity without the bias, in level axes as a
 * fraction of standard gravity (two components, about an angle), then the bias [m/s^2] (three), of
 * which this is a prior, and zero. Of the variable Key::vertical() only the tilt is constrained:
 * yaw and translation keep their values. */
class GravityFactor final : public Factor
{
 public:
  static const FactorType factor_type;

  /** \param upwards measured specific force without the vehicle's own acceleration, vehicle frame
   * of the keyframe [m/s^2] \param bias variable of the accelerometer's bias
   * \throws std::invalid_argument for numbers that are not finite. */
  GravityFactor(std::size_t keyframe,
                const Eigen::Vector3d& upwards,
                const Matrix6& information,
                const Key& bias = Key::accelerometerBias());

  [[nodiscard]] Vector6 residual(ValueBlocks blocks, FactorJacobians* jacobians) const override;
  [[nodiscard]] FactorData data() const override;
  [[nodiscard]] const Eigen::Vector3d& upwards() const { return upwards_; }

 private:
  Eigen::Vector3d upwards_;
};

constexpr double standard_gravity = 9.80665;  //!< [m/s^2]
}  // namespace dyslam
