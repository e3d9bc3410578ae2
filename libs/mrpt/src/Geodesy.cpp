// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mrpt/Geodesy.h>
#include <mrpt/topography/conversions.h>

#include <cmath>
#include <stdexcept>

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

Trajectory inUtm(const Trajectory& of_map, const Georeference& georeference)
{
  const auto utmOf = [&](const Eigen::Vector3d& enu)
  {
    const UtmPosition utm = toUtm(fromEnu(enu, georeference.origin));
    if (utm.epsg() != georeference.epsg)
    {
      throw std::domain_error("the map reaches into another zone of UTM");
    }
    return utm;
  };
  constexpr double short_way = 10;  // to the north, to see where that is in the grid [m]
  Trajectory result;
  for (const auto& [stamp, T_map_vehicle] : of_map)
  {
    const Pose T_enu_vehicle = georeference.T_enu_map * T_map_vehicle;
    const Eigen::Vector3d enu = T_enu_vehicle.translation();
    const UtmPosition here = utmOf(enu);
    const UtmPosition north = utmOf(enu + Eigen::Vector3d(0, short_way, 0));
    const double convergence =
        std::atan2(north.easting - here.easting, north.northing - here.northing);
    const double height = fromEnu(enu, georeference.origin).height;
    Pose T_utm_vehicle = poseFromYpr(0, 0, 0, -convergence, 0, 0) * T_enu_vehicle;
    T_utm_vehicle.translation() << here.easting, here.northing, height;
    result.push_back(stamp, T_utm_vehicle);
  }
  return result;
}
}  // namespace dyslam
