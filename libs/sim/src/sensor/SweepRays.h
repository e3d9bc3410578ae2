// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Splitmix.h>
#include <dyslam/sim/Sensor.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "SweepScene.h"

namespace dyslam::sim
{
/** Constants of the beams, in the order of SensorModel::beams. */
struct BeamTable
{
  std::vector<float> cos_elevation, sin_elevation;
  std::vector<float> cos_offset, sin_offset;  //!< azimuth relative to the head's
  std::vector<float> time;                    //!< time of firing after the start of the column [s]
  std::vector<float> bias;                    //!< constant range error [m]
  std::vector<float> height;                  //!< origin of the beam above that of the lidar [m]
};

/** Random draws of a ray. */
enum class Draw : std::uint64_t
{
  cone,
  range,
  loss,
  mixed,
  intensity,
  count
};

/** The rays of a sweep: their directions and times, and their random numbers. A ray is that of a
 * beam in a column of firings. */
class SweepRays
{
 public:
  /** Direction of the head during a column of firings. */
  struct Column
  {
    std::size_t number = 0;
    float azimuth = 0;
    float cos_azimuth = 1;
    float sin_azimuth = 0;
  };

  /** Both outlive the object. */
  SweepRays(const SensorModel& sensor, const SweepScene& scene);

  [[nodiscard]] std::size_t beamCount() const { return sensor_.beams.size(); }
  [[nodiscard]] const BeamTable& beams() const { return beams_; }
  /** Random bits for a draw of a ray: the same in any order of the calls. */
  [[nodiscard]] std::uint64_t hash(std::size_t column, std::size_t beam, Draw draw) const
  {
    return splitmix64(scene_.seed +
                      ((column * beamCount() + beam) * static_cast<std::uint64_t>(Draw::count) +
                       static_cast<std::uint64_t>(draw)) *
                          splitmix_increment);
  }
  [[nodiscard]] Column columnAt(std::size_t c) const
  {
    const auto azimuth = static_cast<float>(sensor_.azimuth(static_cast<double>(c)));
    return {c, azimuth, std::cos(azimuth), std::sin(azimuth)};
  }
  /** Nominal direction of a beam in the lidar frame, as reported by the sensor. */
  [[nodiscard]] Eigen::Vector3f direction(const Column& column, std::size_t b) const
  {
    if (!sensor_.spins())
    {
      return throughPrisms(column.number, b);
    }
    const float c =
        column.cos_azimuth * beams_.cos_offset[b] - column.sin_azimuth * beams_.sin_offset[b];
    const float s =
        column.sin_azimuth * beams_.cos_offset[b] + column.cos_azimuth * beams_.sin_offset[b];
    return {beams_.cos_elevation[b] * c, beams_.cos_elevation[b] * s, beams_.sin_elevation[b]};
  }
  /** Whether a ray ends on the roof of the car that carries the sensor. */
  [[nodiscard]] bool isOccludedByCarrier(const Column& column, std::size_t b) const;
  /** Time of a column as a fraction of the sweep, in [0, 1); 0.5 without motion distortion. */
  [[nodiscard]] float sweepFraction(std::size_t column) const
  {
    return scene_.motion_distortion
               ? static_cast<float>(column) / static_cast<float>(sensor_.columns)
               : 0.5F;
  }

 private:
  [[nodiscard]] Eigen::Vector3f throughPrisms(std::size_t column, std::size_t b) const;

  const SensorModel& sensor_;
  const SweepScene& scene_;
  BeamTable beams_;
  bool upright_;  //!< the sensor's axes are those of the vehicle
};
}  // namespace dyslam::sim
