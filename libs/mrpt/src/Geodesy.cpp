// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mrpt/Geodesy.h>
#include <mrpt/topography/conversions.h>

#include <cmath>

namespace dyslam
{
namespace
{
mrpt::topography::TGeodeticCoords coordsOf(const GeodeticPosition& position)
{
  return {position.latitude, position.longitude, position.height};
}
}  // namespace

Eigen::Vector3d toEnu(const GeodeticPosition& position, const GeodeticPosition& origin)
{
  mrpt::math::TPoint3D enu;
  mrpt::topography::geodeticToENU_WGS84(coordsOf(position), enu, coordsOf(origin));
  return {enu.x, enu.y, enu.z};
}

// MRPT's own way back (ENUToGeocentric, geocentricToGeodetic) is metres off; so toEnu() is
// inverted.
GeodeticPosition fromEnu(const Eigen::Vector3d& enu, const GeodeticPosition& origin)
{
  constexpr double metres_per_degree = 111320;  // of latitude, within one percent
  constexpr int steps = 8;                      // each leaves a percent of the error
  GeodeticPosition result = origin;
  for (int i = 0; i < steps; ++i)
  {
    const Eigen::Vector3d missing = enu - toEnu(result, origin);
    result.latitude += missing.y() / metres_per_degree;
    result.longitude += missing.x() / (metres_per_degree * std::cos(origin.latitude * M_PI / 180));
    result.height += missing.z();
  }
  return result;
}

UtmPosition toUtm(const GeodeticPosition& position)
{
  UtmPosition utm;
  char band = 'N';
  mrpt::topography::GeodeticToUTM(position.latitude, position.longitude, utm.easting, utm.northing,
                                  utm.zone, band);
  utm.north = position.latitude >= 0;
  return utm;
}
}  // namespace dyslam
