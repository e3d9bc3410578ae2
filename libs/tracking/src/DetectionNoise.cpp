// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Squared.h>
#include <dyslam/tracking/DetectionNoise.h>

#include "ClassOptions.h"

namespace dyslam
{
void ClassNoise::describe(OptionsVisitor& v)
{
  v.real("radial_sigma", radial_sigma, 0.001, 10,
         "sigma of a box's position along the line of sight, at range 0 [m]");
  v.real("radial_sigma_per_range", radial_sigma_per_range, 0, 1,
         "increase with range of the sigma along the line of sight [m/m]");
  v.real("tangential_sigma", tangential_sigma, 0.001, 10,
         "sigma of a box's position across the line of sight, at range 0 [m]");
  v.real("tangential_sigma_per_range", tangential_sigma_per_range, 0, 1,
         "increase with range of the sigma across the line of sight [m/m]");
  v.real("height_sigma", height_sigma, 0.001, 10, "sigma of the height of a box's centre [m]");
  v.degrees("yaw_sigma_deg", yaw_sigma, 0.01, 180, "sigma of a box's heading, at range 0 [deg]");
  v.degrees("yaw_sigma_per_range_deg_m", yaw_sigma_per_range, 0, 10,
            "increase with range of the sigma of the heading [deg/m]");
  v.renamed("radial", "radial_sigma");
  v.renamed("radial_per_range", "radial_sigma_per_range");
  v.renamed("tangential", "tangential_sigma");
  v.renamed("tangential_per_range", "tangential_sigma_per_range");
  v.renamed("height", "height_sigma");
  v.renamed("yaw_deg", "yaw_sigma_deg");
  v.renamed("yaw_per_range_deg", "yaw_sigma_per_range_deg_m");
}

DetectionNoiseOptions::DetectionNoiseOptions()
{
  cyclist.radial_sigma = 0.04;
  cyclist.radial_sigma_per_range = 0.0018;
  cyclist.tangential_sigma = 0.02;
  cyclist.tangential_sigma_per_range = 0.0024;
  cyclist.height_sigma = 0.08;
  cyclist.yaw_sigma = 3 * radians_per_degree;
  cyclist.yaw_sigma_per_range = 0.12 * radians_per_degree;
  pedestrian.radial_sigma = 0.07;
  pedestrian.radial_sigma_per_range = 0.001;
  pedestrian.tangential_sigma = 0.065;
  pedestrian.tangential_sigma_per_range = 0;
  pedestrian.height_sigma = 0.065;
  pedestrian.yaw_sigma = 8 * radians_per_degree;
  pedestrian.yaw_sigma_per_range = 0.2 * radians_per_degree;
}

void DetectionNoiseOptions::describe(OptionsVisitor& v)
{
  v.real("sigma_scale", sigma_scale, 0.01, 100, "factor on all sigmas of the detection noise");
  v.renamed("factor", "sigma_scale");
  describeClasses(*this, v);
}

Eigen::Matrix4d detectionCovariance(const Box& box,
                                    ObjectClass object_class,
                                    const DetectionNoiseOptions& options,
                                    const Eigen::Vector2d& sensor)
{
  const ClassNoise& noise = optionsFor(options, object_class);
  const Eigen::Vector2d sight = box.centre.head<2>() - sensor;
  const double range = sight.norm();
  const Eigen::Vector2d radial =
      range > 0 ? Eigen::Vector2d(sight / range) : Eigen::Vector2d::UnitX();
  const Eigen::Vector2d tangential(-radial.y(), radial.x());
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance.topLeftCorner<2, 2>() =
      squared(noise.radial_sigma + noise.radial_sigma_per_range * range) * radial *
          radial.transpose() +
      squared(noise.tangential_sigma + noise.tangential_sigma_per_range * range) * tangential *
          tangential.transpose();
  covariance(2, 2) = squared(noise.height_sigma);
  covariance(3, 3) = squared(noise.yaw_sigma + noise.yaw_sigma_per_range * range);
  return squared(options.sigma_scale) * covariance;
}
}  // namespace dyslam
