// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>

namespace dyslam
{
/** Use of the accelerations of an IMU. */
enum class GravityUse
{
  off,
  measure,  //!< find the vertical in the map frame; the map is not changed
  fuse,     //!< find the vertical, and optimise the graph with the measured directions
};

struct GravityOptions : Options
{
  GravityUse use = GravityUse::measure;
  bool level_map = false;  //!< rotate the map at the end so that its z axis is vertical
  /** Duration over which accelerations are averaged to one direction [s]. */
  double window = 4;
  double sigma = 0.3 * radians_per_degree;  //!< sigma of a measured direction, per axis [rad]
  double bias_sigma = 0.1;  //!< sigma of the accelerometer's constant error, per axis [m/s^2]

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
