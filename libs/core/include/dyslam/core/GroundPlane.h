// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dyslam
{
/** The plane of the ground around a sensor. */
struct GroundPlane
{
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  //!< unit, upwards
  double height = 0;                                  //!< of the origin above it [m]
  double share = 0;  //!< weighted share of the returns within 15 m that lie on it

  /** Angle between its normal and the z axis, in [0, pi] [rad]. */
  [[nodiscard]] double inclination() const;
  /** Ry(pitch) Rx(roll) turns the normal to the z axis: roll about x, in [-pi, pi], then pitch
   * about y, in [-pi/2, pi/2], both fixed [rad]. */
  [[nodiscard]] double roll() const;
  [[nodiscard]] double pitch() const;
};

/** Where the ground is, seen from the sensor: above one that hangs upside down. */
enum class GroundSide
{
  below,
  above
};

/** Finds the plane of the ground in a scan, for a sensor whose tilt is not known: the one with most
 * surface within 15 m, less what is behind it, that extends in two directions and is inclined by at
 * most 50 degrees. Above the sensor, most of the surface has to be there, too; the same then holds
 * for a ceiling.
 *
 * Planes through three points, drawn with a fixed seed (RANSAC: Fischler and Bolles, 1981), then
 * least squares. The same points give the same plane.
 * \param points axes of the lidar or the vehicle, the origin near the sensor [m]; those that are no
 * returns are ignored
 * \return nothing if no plane has enough surface, as in a forest or a tunnel. */
[[nodiscard]] std::optional<GroundPlane> findGroundPlane(const std::vector<Eigen::Vector3f>& points,
                                                         GroundSide side = GroundSide::below);
}  // namespace dyslam
