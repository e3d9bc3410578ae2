// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

namespace dyslam
{
/** Use of the positions of a satellite receiver. */
enum class GnssUse
{
  off,
  align,  //!< find the pose of the map on the earth; the map is not changed
  fuse,   //!< find the pose of the map, and optimise the graph with the positions
};

struct GnssOptions : Options
{
  GnssUse use = GnssUse::fuse;
  double distance = 5;  //!< distance travelled between two positions that are used [m]
  /** Least extent of the positions that shows the heading; below, none are used [m]. */
  double min_extent = 30;
  double default_sigma = 3;  //!< horizontal sigma if the receiver states none; vertical: twice [m]
  double min_sigma = 0.02;   //!< lower limit of stated sigmas [m]
  /** Correlation time of the receiver's errors: positions within this time count as one [s]. */
  double correlation_time = 60;
  double tilt_sigma = 0.08726646259972;  //!< sigma of the map's z axis from the vertical [rad]

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
