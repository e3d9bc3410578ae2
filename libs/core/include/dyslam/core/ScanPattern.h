// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Properties of a sensor, measured from one of its scans: field of view, rings, spacing, noise.
 * Angles are in the lidar frame [rad]; properties that the scan does not show are 0. */
struct ScanPattern
{
  std::size_t returns = 0;     //!< points that are returns
  bool ring_numbers = false;   //!< Scan::ring is given and names the rings
  bool point_times = false;    //!< Scan::time is given and not the same for all points
  bool firing_order = false;   //!< the points are stored in the order of firing
  double duration = 0;         //!< time between the first and the last point [s]
  double max_range = 0;        //!< farthest return [m]
  double lowest = 0;           //!< elevation of the lowest return, without outliers (0.05 %)
  double highest = 0;          //!< elevation of the highest return, without outliers (0.05 %)
  double azimuth_extent = 0;   //!< horizontal field of view; 2 pi for a full revolution
  double column_spacing = 0;   //!< median angle between neighbours on a ring; 0 without rings
  double ring_spacing = 0;     //!< median angle between neighbouring rings; 0 without rings
  double widest_spacing = 0;   //!< 90 % quantile of the ring spacing; 0 without rings
  double range_noise = 0;      //!< sigma of the range, from neighbours on a ring [m]
  std::vector<float> rings{};  //!< median elevation of each ring with returns, ascending

  [[nodiscard]] bool hasRings() const { return !rings.empty(); }
  /** Angle between neighbouring points in the direction where they are sparser: ring_spacing;
   * without rings, the square root of the solid angle per point. */
  [[nodiscard]] double spacing() const;
};

/** Measures the pattern of one scan, with the rings of ringsOf(). With several lidars, only the
 * points of the first one are used. */
[[nodiscard]] ScanPattern measureScanPattern(const Scan& scan);

/** Ring of each point. The first of these that is valid: `given`, if each ring has one elevation;
 * estimateRings(), under the same condition; `given` of a spinning lidar, if the rings lie one over
 * the other (points that were moved to the vehicle's origin). Empty if the scan has no rings, as
 * the lines of a Livox. */
[[nodiscard]] std::vector<std::uint16_t> ringsOf(const std::vector<Eigen::Vector3f>& points,
                                                 const std::vector<std::uint16_t>& given);
}  // namespace dyslam
