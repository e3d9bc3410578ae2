// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Column of a point in an image of `cols` columns of azimuth: column 0 straight behind, rising
 * clockwise seen from above (so that left is left). */
[[nodiscard]] int azimuthColumn(const Eigen::Vector3f& p, int cols);
/** Angle of a point above the sensor's xy plane [rad]. */
[[nodiscard]] float elevationOf(const Eigen::Vector3f& p);

/** Ring of each point where a recording has none, 0 the lowest; empty if they cannot be found.
 *
 * Files that store one ring after the other (as KITTI's) show it by the azimuth, which jumps back
 * once a ring; where that gives no sensible number of rings, elevations are clustered. Points that
 * are no returns, and those nearer than 1 m if these are fewer than the others, get the ring of the
 * point before.
 */
[[nodiscard]] std::vector<std::uint16_t> estimateRings(const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
