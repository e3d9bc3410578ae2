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
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  //!< unit normal, upwards
  double height = 0;                                  //!< height of the origin above the plane [m]
  double share = 0;  //!< weighted share of the returns within 15 m that lie on the plane

  /** Angle between the normal and the z axis, in [0, pi] [rad]. */
  [[nodiscard]] double inclination() const;
  /** Ry(pitch) Rx(roll) turns the normal to the z axis: roll about x, in [-pi, pi], then pitch
   * about y, in [-pi/2, pi/2], both fixed [rad]. */
  [[nodiscard]] double roll() const;
  [[nodiscard]] double pitch() const;
};

/** Side of the sensor where the ground is: `above` for a sensor that hangs upside down. */
enum class GroundSide
{
  below,
  above
};

/** Finds the ground plane in a scan of a sensor with unknown tilt: the plane with most surface
 * within 15 m, minus the surface behind it, that extends in two directions and is inclined by at
 * most 50 degrees. With the ground above the sensor (GroundSide::above), most of the surface has to
 * be above, too; a ceiling then fulfils this as well.
 *
 * Planes through three points, drawn with a fixed seed (RANSAC: Fischler and Bolles, 1981), then
 * least squares. The same points give the same plane.
 * \param points lidar or vehicle axes, origin near the sensor [m]; points that are no returns are
 * ignored
 * \return nothing if no plane has enough surface, as in a forest or a tunnel. */
[[nodiscard]] std::optional<GroundPlane> findGroundPlane(const std::vector<Eigen::Vector3f>& points,
                                                         GroundSide side = GroundSide::below);
}  // namespace dyslam
