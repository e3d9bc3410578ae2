// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Georeference.h>
#include <dyslam/core/Trajectory.h>

namespace dyslam
{
/** East, north and up from an origin, in the tangent plane of the ellipsoid at the origin [m]. */
[[nodiscard]] Eigen::Vector3d toEnu(const GeodeticPosition& position,
                                    const GeodeticPosition& origin);
/** Inverse of toEnu(). \param enu east, north, up [m] */
[[nodiscard]] GeodeticPosition fromEnu(const Eigen::Vector3d& enu, const GeodeticPosition& origin);

/** The position with geocentric coordinates. \param geocentric x to the equator at Greenwich, z to
 * the north pole, from the centre of the earth (ECEF, WGS84) [m] */
[[nodiscard]] GeodeticPosition fromGeocentric(const Eigen::Vector3d& geocentric);

/** Pose of the east-north-up axes of one origin relative to those of another. */
[[nodiscard]] Pose enuInEnu(const GeodeticPosition& origin, const GeodeticPosition& other);

/** A position in Universal Transverse Mercator coordinates. */
struct UtmPosition
{
  int zone = 0;  //!< 1 to 60
  bool north = true;
  double easting = 0;   //!< [m]
  double northing = 0;  //!< [m]

  /** Number of the coordinate reference system on WGS84: 32632 for zone 32 north. */
  [[nodiscard]] int epsg() const { return (north ? 32600 : 32700) + zone; }
};
/** UTM coordinates in the zone of the position. \pre the latitude is in -80 to 84 deg, where UTM is
 * defined */
[[nodiscard]] UtmPosition toUtm(const GeodeticPosition& position);
/** UTM coordinates in a given zone, which may be a neighbour of the position's own. \param north
 * whether northings count from the equator, else from 10,000 km south of it */
[[nodiscard]] UtmPosition toUtm(const GeodeticPosition& position, int zone, bool north);

/** Poses of a map in UTM coordinates of the zone of the map's origin, also if they reach into a
 * neighbouring zone: easting, northing and height above the ellipsoid [m]; the yaw counts from grid
 * east. Lengths within a scan are not scaled (lengths in UTM differ by up to 0.1 %). */
[[nodiscard]] Trajectory inUtm(const Trajectory& of_map, const Georeference& georeference);
}  // namespace dyslam
