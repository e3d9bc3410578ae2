// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/mrpt/Geodesy.h>
#include <mrpt/topography/conversions.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr double wgs84_axis = 6378137;  // semi-major axis of the ellipsoid [m]
constexpr double wgs84_flattening = 1 / 298.257223563;

mrpt::topography::TGeodeticCoords coordsOf(const GeodeticPosition& position)
{
  return {position.latitude, position.longitude, position.height};
}

/** East, north and up at a position, as columns, in geocentric axes. */
Eigen::Matrix3d enuAxes(const GeodeticPosition& position)
{
  const double latitude = radians_per_degree * position.latitude;
  const double longitude = radians_per_degree * position.longitude;
  const Eigen::Vector3d east(-std::sin(longitude), std::cos(longitude), 0);
  const Eigen::Vector3d up(std::cos(latitude) * std::cos(longitude),
                           std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  Eigen::Matrix3d axes;
  axes << east, up.cross(east), up;
  return axes;
}
}  // namespace

Eigen::Vector3d toEnu(const GeodeticPosition& position, const GeodeticPosition& origin)
{
  mrpt::math::TPoint3D enu;
  mrpt::topography::geodeticToENU_WGS84(coordsOf(position), enu, coordsOf(origin));
  return {enu.x, enu.y, enu.z};
}

// MRPT's own inverse (ENUToGeocentric, geocentricToGeodetic) is wrong by metres, so toEnu() is
// inverted by iteration.
GeodeticPosition fromEnu(const Eigen::Vector3d& enu, const GeodeticPosition& origin)
{
  constexpr double metres_per_degree = 111320;  // degree of latitude, to one percent
  constexpr int steps = 8;                      // each step leaves a percent of the error
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

// Bowring (1976): below a micrometre near the surface, without iteration.
GeodeticPosition fromGeocentric(const Eigen::Vector3d& geocentric)
{
  constexpr double minor_axis = wgs84_axis * (1 - wgs84_flattening);
  constexpr double eccentricity2 = wgs84_flattening * (2 - wgs84_flattening);
  const double from_axis = geocentric.head<2>().norm();
  const double reduced = std::atan2(geocentric.z() * wgs84_axis, from_axis * minor_axis);
  const double latitude =
      std::atan2(geocentric.z() + eccentricity2 / (1 - eccentricity2) * minor_axis *
                                      std::pow(std::sin(reduced), 3),
                 from_axis - eccentricity2 * wgs84_axis * std::pow(std::cos(reduced), 3));
  const double sine = std::sin(latitude);
  const double height = from_axis * std::cos(latitude) + geocentric.z() * sine -
                        wgs84_axis * std::sqrt(1 - eccentricity2 * sine * sine);
  return {degrees_per_radian * latitude,
          degrees_per_radian * std::atan2(geocentric.y(), geocentric.x()), height};
}

Pose enuInEnu(const GeodeticPosition& origin, const GeodeticPosition& other)
{
  Pose T_other_enu = Pose::Identity();
  T_other_enu.linear() = enuAxes(other).transpose() * enuAxes(origin);
  T_other_enu.translation() = toEnu(origin, other);
  return T_other_enu;
}

int utmZoneOf(const GeodeticPosition& position)
{
  const double turned = std::fmod(position.longitude + 180, 360);
  return static_cast<int>((turned < 0 ? turned + 360 : turned) / 6) + 1;
}

// The series of Krueger (1912) to the third order, below a millimetre within a zone and its
// neighbours. MRPT's conversion is centimetres off, and a metre in the south.
UtmPosition toUtm(const GeodeticPosition& position, int zone, bool north)
{
  constexpr double scale = 0.9996;  // scale on the central meridian
  constexpr double n = wgs84_flattening / (2 - wgs84_flattening);
  constexpr std::array<double, 3> series{n / 2 - 2 * n * n / 3 + 5 * n * n * n / 16,
                                         13 * n * n / 48 - 3 * n * n * n / 5, 61 * n * n * n / 240};
  const double radius = scale * wgs84_axis / (1 + n) * (1 + n * n / 4 + n * n * n * n / 64);
  const double eccentricity = 2 * std::sqrt(n) / (1 + n);
  const double sine = std::sin(radians_per_degree * position.latitude);
  const double conformal =
      std::sinh(std::atanh(sine) - eccentricity * std::atanh(eccentricity * sine));
  const double from_meridian = radians_per_degree * (position.longitude - (6 * zone - 183));
  const double xi = std::atan2(conformal, std::cos(from_meridian));
  const double eta = std::atanh(std::sin(from_meridian) / std::hypot(1.0, conformal));
  double northing = xi;
  double easting = eta;
  for (std::size_t i = 0; i < series.size(); ++i)
  {
    const double k = 2 * static_cast<double>(i + 1);
    northing += series[i] * std::sin(k * xi) * std::cosh(k * eta);
    easting += series[i] * std::cos(k * xi) * std::sinh(k * eta);
  }
  return {zone, north, 500000 + radius * easting, (north ? 0 : 10000000) + radius * northing};
}

UtmPosition toUtm(const GeodeticPosition& position)
{
  return toUtm(position, utmZoneOf(position), position.latitude >= 0);
}

Trajectory inUtm(const Trajectory& of_map, const Georeference& georeference)
{
  const bool north_of_equator = georeference.epsg < 32700;
  const auto utmOf = [&](const Eigen::Vector3d& enu)
  { return toUtm(fromEnu(enu, georeference.origin), georeference.epsg % 100, north_of_equator); };
  constexpr double short_way = 10;  // step that shows true north in the grid [m]
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
