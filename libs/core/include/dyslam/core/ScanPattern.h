// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Properties of a sensor, measured from one of its scans: field of view, rings, spacing, noise.
 * Angles are in the lidar frame [rad]; what a scan does not show is 0. */
struct ScanPattern
{
  std::size_t returns = 0;     //!< points that are returns
  bool ring_numbers = false;   //!< Scan::ring is given and names the rings
  bool point_times = false;    //!< Scan::time is given and not the same for all points
  bool firing_order = false;   //!< the points are stored as they were fired
  double duration = 0;         //!< from the first to the last point's time [s]
  double max_range = 0;        //!< farthest return [m]
  double lowest = 0;           //!< elevation of the lowest returns (without 0.05 % of them)
  double highest = 0;          //!< ... and of the highest
  double azimuth_extent = 0;   //!< 2 pi for a full revolution
  double column_spacing = 0;   //!< between neighbours on a ring, median; 0 without rings
  double ring_spacing = 0;     //!< between neighbouring rings, median; 0 without rings
  double widest_spacing = 0;   //!< ... where they are farthest apart, without the widest tenth
  double range_noise = 0;      //!< sigma of the range between neighbours on a ring [m]
  std::vector<float> rings{};  //!< median elevation of each ring with returns, ascending

  [[nodiscard]] bool hasRings() const { return !rings.empty(); }
  /** Angle between neighbouring points in the direction where they are sparser: that of the rings,
   * else the root of the solid angle that a point has. */
  [[nodiscard]] double spacing() const;
};

/** Measures the pattern of one scan, with the rings of ringsOf(). Of several lidars that of the
 * first, the scan's own. */
[[nodiscard]] ScanPattern measureScanPattern(const Scan& scan);

/** Rings of the points: `given` where they have one elevation each, else estimateRings() under the
 * same condition, else `given` of a lidar that turns if they lie one over the other (points that
 * were moved to the vehicle's origin); empty where the scan has no rings, as the lines of a Livox.
 * One per point. */
[[nodiscard]] std::vector<std::uint16_t> ringsOf(const std::vector<Eigen::Vector3f>& points,
                                                 const std::vector<std::uint16_t>& given);
}  // namespace dyslam
