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
  const Eigen::Vector3d far(7310.0772, 5565.4994, 78.3885);  // by the formulas of the ellipsoid
  EXPECT_LT((toEnu({49.05, 8.5, 200}, origin) - far).norm(), 1e-3);
  // A minute of latitude is about 1853 m here, and one of longitude that times the cosine.
  const Eigen::Vector3d north = toEnu({49.0 + 1.0 / 60, 8.4, 115}, origin);
  EXPECT_NEAR(north.y(), 1853.4, 1);
  EXPECT_NEAR(north.x(), 0, 1e-6);
  const Eigen::Vector3d east = toEnu({49.0, 8.4 + 1.0 / 60, 115}, origin);
  EXPECT_NEAR(east.x(), 1219.6, 1);
  EXPECT_GT(east.y(), 0);  // parallels curve towards the pole
}

TEST(Geodesy, UtmOfKnownPlaces)
{
  const UtmPosition karlsruhe = toUtm({49.0, 8.4, 0});
  EXPECT_EQ(karlsruhe.epsg(), 32632);
  EXPECT_NEAR(karlsruhe.easting, 456114.596, 0.1);
  EXPECT_NEAR(karlsruhe.northing, 5427629.204, 0.1);
  EXPECT_EQ(toUtm({-33.86, 151.21, 0}).epsg(), 32756);
  // On the central meridian the easting is that of the zone's middle.
  EXPECT_NEAR(toUtm({10, 9, 0}).easting, 500000, 0.5);
}
}  // namespace dyslam
