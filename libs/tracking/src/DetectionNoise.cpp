// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/DetectionNoise.h>

#include "PrefixedVisitor.h"

namespace dyslam
{
namespace
{
constexpr double degree = M_PI / 180;

const ClassNoise& noiseOf(const DetectionNoiseOptions& options, ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::pedestrian:
      return options.pedestrian;
    case ObjectClass::cyclist:
    case ObjectClass::motorcyclist:
      return options.cyclist;
    default:
      return options.vehicle;
  }
}

constexpr double square(double x)
{
  return x * x;
}
}  // namespace

void ClassNoise::describe(OptionsVisitor& v)
{
  v.real("radial", radial, 0.001, 10, "standard deviation along the line of sight at range 0 [m]");
  v.real("radial_per_range", radial_per_range, 0, 1, "its increase with range, m/m");
  v.real("tangential", tangential, 0.001, 10,
         "standard deviation across the line of sight at range 0 [m]");
  v.real("tangential_per_range", tangential_per_range, 0, 1, "its increase with range, m/m");
  v.real("height", height, 0.001, 10, "standard deviation of the height [m]");
  v.degrees("yaw_deg", yaw, 0.01, 180, "standard deviation of the heading at range 0, deg");
  v.degrees("yaw_per_range_deg", yaw_per_range, 0, 10, "its increase with range, deg/m");
}

DetectionNoiseOptions::DetectionNoiseOptions()
{
  vehicle.yaw = 2 * degree;
  vehicle.yaw_per_range = 0.08 * degree;
  cyclist.radial = 0.04;
  cyclist.radial_per_range = 0.0018;
  cyclist.tangential = 0.02;
  cyclist.tangential_per_range = 0.0024;
  cyclist.height = 0.08;
  cyclist.yaw = 3 * degree;
  cyclist.yaw_per_range = 0.12 * degree;
  pedestrian.radial = 0.07;
  pedestrian.radial_per_range = 0.001;
  pedestrian.tangential = 0.065;
  pedestrian.tangential_per_range = 0;
  pedestrian.height = 0.065;
  pedestrian.yaw = 8 * degree;
  pedestrian.yaw_per_range = 0.2 * degree;
}

void DetectionNoiseOptions::describe(OptionsVisitor& v)
{
  v.real("factor", factor, 0.01, 100, "factor on all standard deviations");
  PrefixedVisitor vehicles(v, "vehicle_");
  vehicle.describe(vehicles);
  PrefixedVisitor cyclists(v, "cyclist_");
  cyclist.describe(cyclists);
  PrefixedVisitor pedestrians(v, "pedestrian_");
  pedestrian.describe(pedestrians);
}

Eigen::Matrix4d detectionCovariance(const Box& box,
                                    ObjectClass object_class,
                                    const DetectionNoiseOptions& options,
                                    const Eigen::Vector2d& sensor)
{
  const ClassNoise& noise = noiseOf(options, object_class);
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
