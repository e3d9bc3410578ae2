// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
TEST(Geodesy, EnuThereAndBack)
{
  const GeodeticPosition origin{49.0, 8.4, 115};
  for (const Eigen::Vector3d& enu : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1200, -800, 35),
                                     Eigen::Vector3d(-9000, 7000, -4)})
  {
    const GeodeticPosition there = fromEnu(enu, origin);
    EXPECT_LT((toEnu(there, origin) - enu).norm(), 1e-3);
  }
  const Eigen::Vector3d far(7310.0772, 5565.4994,
                            78.3885);  // computed by the formulas of the ellipsoid
  EXPECT_LT((toEnu({49.05, 8.5, 200}, origin) - far).norm(), 1e-3);
  // A minute of latitude is about 1853 m here, a minute of longitude that times the cosine of the
  // latitude.
  const Eigen::Vector3d north = toEnu({49.0 + 1.0 / 60, 8.4, 115}, origin);
  EXPECT_NEAR(north.y(), 1853.4, 1);
  EXPECT_NEAR(north.x(), 0, 1e-6);
  const Eigen::Vector3d east = toEnu({49.0, 8.4 + 1.0 / 60, 115}, origin);
  EXPECT_NEAR(east.x(), 1219.6, 1);
  EXPECT_GT(east.y(), 0);  // parallels curve towards the pole
}

TEST(Geodesy, GeocentricPositions)
{
  const GeodeticPosition greenwich = fromGeocentric({6378137 + 10, 0, 0});
  EXPECT_NEAR(greenwich.latitude, 0, 1e-12);
  EXPECT_NEAR(greenwich.longitude, 0, 1e-12);
  EXPECT_NEAR(greenwich.height, 10, 1e-6);
  EXPECT_NEAR(fromGeocentric({0, 0, -6356752.314245}).latitude, -90, 1e-9);
  EXPECT_NEAR(fromGeocentric({0, 0, -6356752.314245}).height, 0, 1e-5);
  const double axis = 6378137;
  const double flattening = 1 / 298.257223563;
  for (const GeodeticPosition& position :
       {GeodeticPosition{52.2, 21.07, 141.8}, GeodeticPosition{-33.86, 151.21, 40},
        GeodeticPosition{69.6, -120.3, 8000}})
  {
    const double latitude = position.latitude * M_PI / 180;
    const double longitude = position.longitude * M_PI / 180;
    const double eccentricity2 = flattening * (2 - flattening);
    const double normal = axis / std::sqrt(1 - eccentricity2 * std::pow(std::sin(latitude), 2));
    const GeodeticPosition found =
        fromGeocentric({(normal + position.height) * std::cos(latitude) * std::cos(longitude),
                        (normal + position.height) * std::cos(latitude) * std::sin(longitude),
                        (normal * (1 - eccentricity2) + position.height) * std::sin(latitude)});
    EXPECT_NEAR(found.latitude, position.latitude, 1e-10);
    EXPECT_NEAR(found.longitude, position.longitude, 1e-10);
    EXPECT_NEAR(found.height, position.height, 1e-6);
  }
}

TEST(Geodesy, EnuInTheAxesOfAnotherOrigin)
{
  const GeodeticPosition here{49.0, 8.4, 115};
  for (const GeodeticPosition& other :
       {here, GeodeticPosition{49.02, 8.37, 60}, GeodeticPosition{-33.86, 151.21, 40}})
  {
    const Pose T_other_here = enuInEnu(here, other);
    for (const Eigen::Vector3d& enu : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1200, -800, 35)})
    {
      EXPECT_LT((T_other_here * enu - toEnu(fromEnu(enu, here), other)).norm(), 2e-3);
    }
  }
}

TEST(Geodesy, TrajectoryInUtm)
{
  Georeference georeference;
  georeference.origin = {49, 8.4, 115};
  georeference.T_enu_map = poseFromYpr(100, 50, -2, M_PI / 2, 0, 0);
  georeference.epsg = 32632;
  Trajectory of_map;
  of_map.push_back(1, Pose::Identity());
  of_map.push_back(2, poseFromYpr(200, 0, 3, 0.5, 0, 0));  // 200 m to the north
  const Trajectory utm = inUtm(of_map, georeference);
  ASSERT_EQ(utm.size(), 2U);
  const Eigen::Vector3d first = utm[0].pose.translation();
  const UtmPosition expected = toUtm(fromEnu({100, 50, -2}, georeference.origin));
  EXPECT_NEAR(first.x(), expected.easting, 1e-3);
  EXPECT_NEAR(first.y(), expected.northing, 1e-3);
  EXPECT_NEAR(first.z(), 113, 0.01);
  const Eigen::Vector3d moved = utm[1].pose.translation() - first;
  EXPECT_NEAR(moved.head<2>().norm(), 200 * 0.9996, 0.02);
  EXPECT_NEAR(moved.z(), 3, 0.02);
  // West of the central meridian (9 deg) true north is to the right of the grid's by 0.45 deg.
  const double convergence = (9 - 8.4) * std::sin(49 * M_PI / 180) * M_PI / 180;
  EXPECT_NEAR(std::atan2(moved.x(), moved.y()), convergence, 1e-4);
  const Eigen::Vector3d ahead = utm[0].pose.linear().col(0);  // north
  EXPECT_NEAR(std::atan2(ahead.x(), ahead.y()), convergence, 1e-4);

  // Beyond the border of the zone its coordinates continue.
  georeference.origin.longitude = 11.9999;
  of_map.push_back(3, poseFromYpr(0, -1000, 0, 0, 0, 0));  // 1 km to the east
  const Trajectory beyond = inUtm(of_map, georeference);
  EXPECT_NEAR((beyond[2].pose.translation() - beyond[0].pose.translation()).head<2>().norm(), 1000,
              1);
}

TEST(Geodesy, UtmOfKnownPlaces)
{
  const UtmPosition karlsruhe = toUtm({49.0, 8.4, 0});
  EXPECT_EQ(karlsruhe.epsg(), 32632);
  EXPECT_NEAR(karlsruhe.easting, 456114.596, 1e-3);
  EXPECT_NEAR(karlsruhe.northing, 5427629.204, 1e-3);
  const UtmPosition sydney = toUtm({-33.86, 151.21, 0});
  EXPECT_EQ(sydney.epsg(), 32756);
  EXPECT_NEAR(sydney.easting, 334416.3940, 1e-3);
  EXPECT_NEAR(sydney.northing, 6251925.3604, 1e-3);
  EXPECT_EQ(toUtm({0, 180, 0}).zone, 1);
  EXPECT_EQ(toUtm({0, 359, 0}).zone, 30);
  // On the central meridian the easting is 500 km.
  EXPECT_NEAR(toUtm({10, 9, 0}).easting, 500000, 0.5);
}
}  // namespace dyslam
