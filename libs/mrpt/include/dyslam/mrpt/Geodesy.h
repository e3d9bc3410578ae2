// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Georeference.h>
#include <dyslam/core/Trajectory.h>

namespace dyslam
{
/** East, north and up from an origin, in the plane that touches the ellipsoid there [m]. */
[[nodiscard]] Eigen::Vector3d toEnu(const GeodeticPosition& position,
                                    const GeodeticPosition& origin);
[[nodiscard]] GeodeticPosition fromEnu(const Eigen::Vector3d& enu, const GeodeticPosition& origin);

/** Universal Transverse Mercator. */
struct UtmPosition
{
  int zone = 0;  //!< 1 to 60
  bool north = true;
  double easting = 0;   //!< [m]
  double northing = 0;  //!< [m]

  /** Number of the coordinate reference system on WGS84: 32632 for zone 32 north. */
  [[nodiscard]] int epsg() const { return (north ? 32600 : 32700) + zone; }
};
/** \pre latitudes of -80 to 84 deg, where UTM is defined */
[[nodiscard]] UtmPosition toUtm(const GeodeticPosition& position);
/** In a zone that may be a neighbour of its own. \param north whether northings count from the
 * equator, else from 10,000 km south of it */
[[nodiscard]] UtmPosition toUtm(const GeodeticPosition& position, int zone, bool north);

/** Poses of a map in the zone of UTM of its origin: easting, northing, height above the ellipsoid;
 * the rotation is from the grid's east. Lengths of a scan stay as they are (those of UTM differ by
 * up to 0.1 %). Also where they reach into a neighbouring zone. */
[[nodiscard]] Trajectory inUtm(const Trajectory& of_map, const Georeference& georeference);
}  // namespace dyslam
