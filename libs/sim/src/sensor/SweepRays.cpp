// SPDX-License-Identifier: BSD-3-Clause
#include "SweepRays.h"

#include "Random.h"

namespace dyslam::sim
{
namespace
{
BeamTable tabulate(const SensorModel& sensor)
{
  BeamTable t;
  for (std::size_t i = 0; i < sensor.beams.size(); ++i)
  {
    const Beam& b = sensor.beams[i];
    // A beam's range error is constant, as in a real sensor. Its elevation is exact: the ray is
    // cast and the point reported with the same value.
    const std::uint64_t h = combine(0x5E4504, i);
    const double elevation =
        b.elevation + sensor.beam_angle_error * static_cast<double>(normal(combine(h, 1)));
    const double offset = b.azimuth_offset - 2 * M_PI * b.fire_time / sensor.period;
    t.cos_elevation.push_back(static_cast<float>(std::cos(elevation)));
    t.sin_elevation.push_back(static_cast<float>(std::sin(elevation)));
    t.cos_offset.push_back(static_cast<float>(std::cos(offset)));
    t.sin_offset.push_back(static_cast<float>(std::sin(offset)));
    t.time.push_back(static_cast<float>(b.fire_time));
    t.bias.push_back(static_cast<float>(sensor.beam_range_bias) * normal(combine(h, 2)));
    t.height.push_back(static_cast<float>(b.height));
  }
  return t;
}
}  // namespace

SweepRays::SweepRays(const SensorModel& sensor, const SweepScene& scene)
    : sensor_(sensor),
      scene_(scene),
      beams_(tabulate(sensor)),
      upright_(scene.R_vehicle_lidar.isIdentity())
{
}

Eigen::Vector3f SweepRays::throughPrisms(std::size_t column, std::size_t b) const
{
  const Beam& beam = sensor_.beams[b];
  const double share = static_cast<double>(column) / sensor_.columns;
  const RayAngles a =
      sensor_.throughPrisms(scene_.start + sensor_.period * share + beam.fire_time, beam);
  return Eigen::Vector3d(std::cos(a.elevation) * std::cos(a.azimuth),
                         std::cos(a.elevation) * std::sin(a.azimuth), std::sin(a.elevation))
      .cast<float>();
}

bool SweepRays::isOccludedByCarrier(const Column& column, std::size_t b) const
{
  if (!scene_.on_car)
  {
    return false;
  }
  float a = std::abs(column.azimuth);
  float sine = beams_.sin_elevation[b];
  if (!upright_ || !sensor_.spins())
  {
    const Eigen::Vector3f ray = scene_.R_vehicle_lidar * direction(column, b);
    a = std::abs(std::atan2(ray.y(), ray.x()));
    sine = ray.z();
  }
  const float limit = a > 2.55F   ? -0.315F + 0.10F * (3.1416F - a)
                      : a > 2.05F ? -0.40F
                      : a > 1.9F  ? -0.37F
                      : a < 0.4F  ? -0.395F - 0.08F * a
                                  : -1.0F;
  return sine < limit;
}
}  // namespace dyslam::sim
