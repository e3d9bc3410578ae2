// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>

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
  /** Horizontal sigma of a position where the receiver states none; vertical: twice [m]. */
  double default_sigma = 3;
  double min_sigma = 0.02;  //!< smallest sigma that is believed [m]
  /** How long the receiver's errors last: the positions within this time count as one [s]. */
  double correlation_time = 60;
  /** Error of the trajectory between two positions, as a fraction of the path between them, beyond
   * which one of them is an outlier; 0: outliers are not searched for. */
  double drift = 0.02;
  /** Sigma of the angle between the map's z axis and the vertical [rad]. */
  double tilt_sigma = 5 * radians_per_degree;

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
