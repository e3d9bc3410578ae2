// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>

namespace dyslam
{
/** Standard deviations of a detected box's errors, growing linearly with the range r from the
 * sensor. */
struct ClassNoise : Options
{
  double radial_sigma = 0.08;             //!< sigma along the line of sight at r = 0 [m]
  double radial_sigma_per_range = 0.005;  //!< increase of radial_sigma with range [m/m]
  double tangential_sigma = 0.05;  //!< sigma across the line of sight, horizontally, at r = 0 [m]
  double tangential_sigma_per_range = 0.0015;  //!< increase of tangential_sigma with range [m/m]
  double height_sigma = 0.06;                  //!< sigma of the centre's z [m]
  double yaw_sigma = 2 * radians_per_degree;   //!< sigma of the heading at r = 0 [rad]
  /** Increase of yaw_sigma with range [rad/m]. */
  double yaw_sigma_per_range = 0.08 * radians_per_degree;

  void describe(OptionsVisitor& visitor) override;
};

/** Noise of detected boxes by class. The defaults are those of PointRCNN on KITTI. Its errors are
 * correlated from scan to scan: filters that assume white noise need a `sigma_scale` of 2 to 4. */
struct DetectionNoiseOptions : Options
{
  double sigma_scale = 1;  //!< factor on all standard deviations
  ClassNoise vehicle;
  ClassNoise cyclist;
  ClassNoise pedestrian;

  DetectionNoiseOptions();
  void describe(OptionsVisitor& visitor) override;
};

/** Covariance of x, y, z [m^2], yaw [rad^2] of a box, in the box's frame.
 * \param sensor position of the lidar in the same frame [m], which radial and tangential refer to
 */
[[nodiscard]] Eigen::Matrix4d detectionCovariance(
    const Box& box,
    ObjectClass object_class,
    const DetectionNoiseOptions& options,
    const Eigen::Vector2d& sensor = Eigen::Vector2d::Zero());
}  // namespace dyslam
