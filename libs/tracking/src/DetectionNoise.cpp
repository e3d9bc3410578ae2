// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Angle.h>
#include <dyslam/tracking/DetectionNoise.h>

#include "ClassOptions.h"

namespace dyslam
{
namespace
{
constexpr double square(double x)
{
  return x * x;
}
}  // namespace

void ClassNoise::describe(OptionsVisitor& v)
{
  v.real("radial", radial, 0.001, 10,
         "sigma of a box's position along the line of sight, at range 0 [m]");
  v.real("radial_per_range", radial_per_range, 0, 1,
         "increase with range of the sigma along the line of sight [m/m]");
  v.real("tangential", tangential, 0.001, 10,
         "sigma of a box's position across the line of sight, at range 0 [m]");
  v.real("tangential_per_range", tangential_per_range, 0, 1,
         "increase with range of the sigma across the line of sight [m/m]");
  v.real("height", height, 0.001, 10, "sigma of the height of a box's centre [m]");
  v.degrees("yaw_deg", yaw, 0.01, 180, "sigma of a box's heading, at range 0 [deg]");
  v.degrees("yaw_per_range_deg", yaw_per_range, 0, 10,
            "increase with range of the sigma of the heading [deg/m]");
}

DetectionNoiseOptions::DetectionNoiseOptions()
{
  cyclist.radial = 0.04;
  cyclist.radial_per_range = 0.0018;
  cyclist.tangential = 0.02;
  cyclist.tangential_per_range = 0.0024;
  cyclist.height = 0.08;
  cyclist.yaw = 3 * radians_per_degree;
  cyclist.yaw_per_range = 0.12 * radians_per_degree;
  pedestrian.radial = 0.07;
  pedestrian.radial_per_range = 0.001;
  pedestrian.tangential = 0.065;
  pedestrian.tangential_per_range = 0;
  pedestrian.height = 0.065;
  pedestrian.yaw = 8 * radians_per_degree;
  pedestrian.yaw_per_range = 0.2 * radians_per_degree;
}

void DetectionNoiseOptions::describe(OptionsVisitor& v)
{
  v.real("factor", factor, 0.01, 100, "factor on all sigmas of the detection noise");
  describeClasses(*this, v);
}

Eigen::Matrix4d detectionCovariance(const Box& box,
                                    ObjectClass object_class,
                                    const DetectionNoiseOptions& options,
                                    const Eigen::Vector2d& sensor)
{
  const ClassNoise& noise = optionsFor(options, object_class);
  const Eigen::Vector2d sight = box.center.head<2>() - sensor;
  const double range = sight.norm();
  const Eigen::Vector2d radial =
      range > 0 ? Eigen::Vector2d(sight / range) : Eigen::Vector2d::UnitX();
  const Eigen::Vector2d tangential(-radial.y(), radial.x());
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance.topLeftCorner<2, 2>() =
      square(noise.radial + noise.radial_per_range * range) * radial * radial.transpose() +
      square(noise.tangential + noise.tangential_per_range * range) * tangential *
          tangential.transpose();
  covariance(2, 2) = square(noise.height);
  covariance(3, 3) = square(noise.yaw + noise.yaw_per_range * range);
  return square(options.factor) * covariance;
}
}  // namespace dyslam
