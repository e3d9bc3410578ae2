// SPDX-License-Identifier: BSD-3-Clause
// The points of a map in files, read back and byte by byte.
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapexport/MapCloudFile.h>
#include <dyslam/mapexport/MapExport.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "CloudFormat.h"
#include "TestFolder.h"
#include "TestRoom.h"

namespace dyslam
{
namespace
{
TEST(MapCloudFile, CloudsRoundTrip)
{
  const TestFolder folder;
  const auto points = test::room().map.points();
  ASSERT_GT(points.size(), 1000U);
  for (const std::string name : {"m.pcd", "m.ply"})
  {
    writeMapCloud(points, folder.file(name));
    const Scan back = readCloud(folder.file(name));
    ASSERT_EQ(back.size(), points.size());
    EXPECT_EQ(back.points, points.points);
    EXPECT_EQ(back.intensity, points.intensity);
    const auto first = folder.read(name);
    writeMapCloud(points, folder.file(name));
    EXPECT_EQ(folder.read(name), first);
  }
  EXPECT_THROW(writeMapCloud(points, folder.file("m.xyz")), UserError);
}

template <typename T>
T numberAt(const std::string& bytes, std::size_t at)
{
  T value{};
  std::memcpy(&value, &bytes.at(at), sizeof value);
  return value;
}

/** By the offsets of the specifications: LAS 1.2, and 1.4 for the extra bytes. */
TEST(MapCloudFile, LasIsAsSpecifiedAndExactFarFromZero)
{
  const TestFolder folder;
  MapPoints points;
  points.points = {{1.0004F, -2, 0.5F}, {-70.25F, 900.125F, -3}, {0, 0, 0}};
  points.intensity = {0, 1, 0.5F};
  points.normals = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}};
  const Eigen::Vector3d origin(448000, 5428000, 0);
  writeMapCloud(points, folder.file("m.las"), origin);
  const std::string las = folder.read("m.las");
  ASSERT_GT(las.size(), 227U);
  EXPECT_EQ(las.substr(0, 4), "LASF");
  EXPECT_EQ(las.substr(24, 2), "\x01\x02");
  EXPECT_EQ(numberAt<std::uint16_t>(las, 94), 227);
  const auto data = numberAt<std::uint32_t>(las, 96);
  EXPECT_EQ(data, 227U + 54 + 3 * 192);
  EXPECT_EQ(numberAt<std::uint32_t>(las, 100), 1U);
  EXPECT_EQ(las[104], 0);
  const auto record = numberAt<std::uint16_t>(las, 105);
  EXPECT_EQ(record, 20 + 12);
  ASSERT_EQ(las.size(), data + 3U * record);
  EXPECT_EQ(numberAt<std::uint32_t>(las, 107), 3U);
  EXPECT_EQ(numberAt<std::uint32_t>(las, 111), 3U);
  for (std::size_t i = 0; i < 3; ++i)
  {
    const std::size_t at = data + i * record;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const double value =
          numberAt<std::int32_t>(las, at + 4 * axis) * numberAt<double>(las, 131 + 8 * axis) +
          numberAt<double>(las, 155 + 8 * axis);
      const auto k = static_cast<Eigen::Index>(axis);
      EXPECT_NEAR(value, origin[k] + static_cast<double>(points.points[i][k]), 0.00051);
      EXPECT_GE(value, numberAt<double>(las, 187 + 16 * axis));
      EXPECT_LE(value, numberAt<double>(las, 179 + 16 * axis));
      EXPECT_EQ(numberAt<float>(las, at + 20 + 4 * axis), points.normals[i][k]);
    }
    EXPECT_NEAR(numberAt<std::uint16_t>(las, at + 12) / 65535.0,
                static_cast<double>(points.intensity[i]), 1e-5);
    EXPECT_EQ(las[at + 14], 0x09);
  }
  EXPECT_EQ(las.substr(227 + 2, 9), "LASF_Spec");
  EXPECT_EQ(numberAt<std::uint16_t>(las, 227 + 18), 4);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::size_t at = 227 + 54 + 192 * axis;
    EXPECT_EQ(las[at + 2], 9);
    EXPECT_EQ(las.substr(at + 4, 7), std::string("Normal") + "XYZ"[axis]);
    EXPECT_EQ(las.substr(at + 160, 10), "towards th");
  }
}

/** Bytes 90 to 93: day of the year and year, in UTC. */
TEST(MapCloudFile, TheDateOfALasIsThatOfTheRecording)
{
  const TestFolder folder;
  const auto dateOf = [&](std::optional<double> recorded)
  {
    MapCloudFile file(folder.file("m.las"), {false, Eigen::Vector3d::Zero(), recorded, 0});
    file.close();
    const std::string las = folder.read("m.las");
    return std::pair<int, int>(numberAt<std::uint16_t>(las, 90), numberAt<std::uint16_t>(las, 92));
  };
  EXPECT_EQ((std::pair<int, int>(269, 2011)), dateOf(1317042752.9));  // 26 September, 13:12
  EXPECT_EQ((std::pair<int, int>(366, 2020)), dateOf(1609459199));    // 31 December, 23:59:59
  for (const std::optional<double> none :  // a clock that counts from its start: 1000 s, a year
       {std::optional<double>(), std::optional<double>(-1), std::optional<double>(1000),
        std::optional<double>(3.2e7),
        std::optional<double>(std::numeric_limits<double>::quiet_NaN()),
        std::optional<double>(1e300)})
  {
    EXPECT_EQ((std::pair<int, int>(0, 0)), dateOf(none));
  }
}

/** By LAS 1.2 and the keys of GeoTIFF: a record behind the header, and behind that of the normals.
 */
TEST(MapCloudFile, ALasStatesItsReferenceSystem)
{
  const TestFolder folder;
  MapPoints points;
  points.points = {{1, 2, 3}};
  points.intensity = {0.5F};
  points.normals = {{0, 0, 1}};
  for (const bool normals : {false, true})
  {
    MapCloudFile file(folder.file("m.las"),
                      {normals, Eigen::Vector3d::Zero(), std::nullopt, 32632});
    file.add(points);
    file.close();
    const std::string las = folder.read("m.las");
    const std::size_t at = 227 + (normals ? 54 + 3 * 192 : 0);
    const std::size_t data = at + 54 + 32;
    EXPECT_EQ(numberAt<std::uint32_t>(las, 96), data);
    EXPECT_EQ(numberAt<std::uint32_t>(las, 100), normals ? 2U : 1U);
    ASSERT_EQ(las.size(), data + (normals ? 32U : 20U));
    EXPECT_EQ(numberAt<std::int32_t>(las, data), 1000);
    EXPECT_EQ(las.substr(at + 2, 15), "LASF_Projection");
    EXPECT_EQ(numberAt<std::uint16_t>(las, at + 18), 34735);
    EXPECT_EQ(numberAt<std::uint16_t>(las, at + 20), 32);
    std::map<int, int> keys;
    const int count = numberAt<std::uint16_t>(las, at + 54 + 6);
    for (int key = 1; key <= count; ++key)
    {
      const std::size_t entry = at + 54 + 8 * static_cast<std::size_t>(key);
      EXPECT_EQ(numberAt<std::uint16_t>(las, entry + 2), 0);  // the value is in the entry
      keys[numberAt<std::uint16_t>(las, entry)] = numberAt<std::uint16_t>(las, entry + 6);
    }
    EXPECT_EQ(keys, (std::map<int, int>{{1024, 1}, {3072, 32632}, {3076, 9001}}));
  }
}

TEST(MapCloudFile, CloudsFarFromZeroKeepTheirPrecision)
{
  const TestFolder folder;
  MapPoints points;
  points.points = {{1.25F, -2, 0.5F}};
  points.intensity = {0.5F};
  const Eigen::Vector3d origin(448000, 5428000, 0);
  writeMapCloud(points, folder.file("m.ply"), origin);
  const std::string ply = folder.read("m.ply");
  const std::size_t data = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("property double x\n"), std::string::npos);
  EXPECT_EQ(numberAt<double>(ply, data), 448001.25);
  EXPECT_EQ(numberAt<double>(ply, data + 8), 5427998.0);
  writeMapCloud(points, folder.file("m.pcd"), origin);
  EXPECT_EQ(readCloud(folder.file("m.pcd")).points, points.points);
  EXPECT_NE(folder.read("m.pcd").find("VIEWPOINT 448000 5428000 0 1 0 0 0\n"), std::string::npos);
}

TEST(MapCloudFile, ACloudWithNormalsNeedsThemOfAllPoints)
{
  const TestFolder folder;
  MapPoints points;
  points.points = {{1, 2, 3}};
  points.intensity = {0.5F};
  MapCloudFile file(folder.file("m.ply"), true);
  EXPECT_THROW(file.add(points), std::invalid_argument);
  points.normals = {{0, 0, 1}};
  file.add(points);
  EXPECT_EQ(file.count(), 1U);
  EXPECT_FALSE(std::filesystem::exists(folder.file("m.ply"))) << "it is not closed";
  file.close();
  EXPECT_EQ(readCloud(folder.file("m.ply")).points, points.points);
}

/** The point counts of LAS 1.2, and of PCL, which reads PCD, have 32 bits. */
TEST(MapCloudFile, FormatsHoldAsManyPointsAsTheirReadersCount)
{
  const TestFolder folder;
  constexpr std::uint64_t of_32_bits = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(makeLasFormat({})->maxPoints(), of_32_bits);
  EXPECT_EQ(makePcdFormat({})->maxPoints(), of_32_bits);
  EXPECT_GT(makePlyFormat({})->maxPoints(), of_32_bits);
}

TEST(MapCloudFile, CoordinatesBeyondTheStepsOfALasAreRefused)
{
  const TestFolder folder;
  MapPoints points;
  points.points = {{1, 2, 3}, {0, -2147000, 0}};
  points.intensity = {0, 0};
  writeMapCloud(points, folder.file("m.las"));
  const std::string within = folder.read("m.las");
  EXPECT_EQ(-2147000000, numberAt<std::int32_t>(within, within.size() - 20 + 4));
  points.points[1].y() = -5400000;
  const std::string said =
      messageOfError<UserError>([&] { writeMapCloud(points, folder.file("m.las")); });
  EXPECT_EQ(folder.file("m.las") +
                ": the format reaches 2147 km, but the map reaches 5400 km from its origin; are "
                "all poses of the trajectory right?",
            said);
  EXPECT_EQ(within, folder.read("m.las")) << "the earlier file stays";
  writeMapCloud(points, folder.file("m.ply"));
  EXPECT_EQ(-5400000, readCloud(folder.file("m.ply")).points[1].y());
}
}  // namespace
}  // namespace dyslam
