// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/mapexport/MapFormat.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <octomap/OcTree.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "FullDisk.h"
#include "TestFolder.h"
#include "TestMap.h"
#include "TestRoom.h"

namespace dyslam
{
namespace
{
TEST(MapExport, KeyframesAreCountedWhenTheyAreDone)
{
  const TestFolder folder;
  test::TestMap held = test::room();
  Frame lost;
  lost.index = 100;
  lost.T_odom_vehicle.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
  held.insert(lost);
  const std::vector<std::size_t> all{1, 2, 3, 4};
  for (const std::string name : {"m.bt", "m.gridmap", "m.simplemap"})
  {
    std::vector<std::size_t> done;
    const MapProgress count = [&](std::size_t keyframes) { done.push_back(keyframes); };
    switch (mapFormatOf(name).kind)
    {
      case MapKind::octree:
        writeOctomap(held.map, folder.file(name), {}, Eigen::Vector3d::Zero(), count);
        break;
      case MapKind::grid:
        writeOccupancyGrid(held.map, folder.file(name), {}, Eigen::Vector3d::Zero(), count);
        break;
      default:
        writeSimplemap(held.map, folder.file(name), Eigen::Vector3d::Zero(), {}, count);
    }
    EXPECT_EQ(done, all) << name;
  }
}

TEST(MapExport, SimplemapHoldsPosesAndClouds)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  writeSimplemap(map, folder.file("m.simplemap"));
  const auto first = folder.read("m.simplemap");
  writeSimplemap(map, folder.file("m.simplemap"));
  EXPECT_EQ(folder.read("m.simplemap"), first);

  mrpt::maps::registerAllClasses_mrpt_maps();
  mrpt::maps::CSimpleMap back;
  ASSERT_TRUE(back.loadFromFile(folder.file("m.simplemap")));
  ASSERT_EQ(back.size(), 3U);
  std::size_t points = 0;
  for (std::size_t k = 0; k < back.size(); ++k)
  {
    const auto [pose, frame] = back.getAsPair(k);
    const auto mean = pose->getMeanVal();
    EXPECT_NEAR(mean.x(), static_cast<double>(k), 1e-9);
    EXPECT_NEAR(mean.yaw(), 0.2, 1e-9);
    const auto cloud = frame->getObservationByClass<mrpt::obs::CObservationPointCloud>();
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->sensorLabel, "lidar");
    points += cloud->pointcloud->size();
  }
  EXPECT_EQ(points, held.pointCount());
}

TEST(MapExport, SimplemapOfAnAreaHasTheKeyframesWithPointsThere)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  MapRegion area;
  area.low = {-5, 2};
  area.high = {0, 4};
  std::vector<std::size_t> expected;  // numbers of points of the keyframes
  held.map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        std::size_t count = 0;
        for (const Eigen::Vector3f& p : cloud.points)
        {
          count += area.contains(held.map.poses()[k] * p.cast<double>()) ? 1 : 0;
        }
        if (count > 0)
        {
          expected.push_back(count);
        }
      });
  ASSERT_FALSE(expected.empty());
  mrpt::maps::registerAllClasses_mrpt_maps();
  std::vector<std::size_t> done;
  writeSimplemap(held.map, folder.file("m.simplemap"), {1000, 2000, 0}, area,
                 [&](std::size_t keyframes) { done.push_back(keyframes); });
  EXPECT_EQ(done, (std::vector<std::size_t>{1, 2, 3}));
  mrpt::maps::CSimpleMap back;
  ASSERT_TRUE(back.loadFromFile(folder.file("m.simplemap")));
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < back.size(); ++k)
  {
    const auto cloud =
        back.getAsPair(k).sf->getObservationByClass<mrpt::obs::CObservationPointCloud>();
    found.push_back(cloud->pointcloud->size());
  }
  EXPECT_EQ(found, expected);

  area.low.x() = -200;
  area.high.x() = -100;
  writeSimplemap(held.map, folder.file("m.simplemap"), Eigen::Vector3d::Zero(), area);
  ASSERT_TRUE(back.loadFromFile(folder.file("m.simplemap")));
  EXPECT_EQ(back.size(), 0U);
}

TEST(MapExport, SimplemapIsWhatMrptWouldWrite)
{
  const TestFolder folder;
  mrpt::maps::registerAllClasses_mrpt_maps();
  writeSimplemap(test::room().map, folder.file("a.simplemap"), {1000, 2000, 0});
  mrpt::maps::CSimpleMap map;
  ASSERT_TRUE(map.loadFromFile(folder.file("a.simplemap")));
  std::vector<std::uint8_t> expected;
  mrpt::serialization::ObjectToOctetVector(&map, expected);
  mrpt::io::CFileGZInputStream file(folder.file("a.simplemap"));
  std::vector<std::uint8_t> written(2 * expected.size());
  written.resize(file.Read(written.data(), written.size()));
  EXPECT_EQ(written, expected);
}

TEST(MapExport, AnAreaIsFourNumbersInOrder)
{
  MapExportOptions options;
  EXPECT_TRUE(areaOf(options).contains({1e9, -1e9, 0})) << "everything";
  options.area = "-20,-10,40.5,30";
  const MapRegion area = areaOf(options, {-100, 1000, 7});
  EXPECT_TRUE(area.low.isApprox(Eigen::Vector2d(80, -1010)));
  EXPECT_TRUE(area.high.isApprox(Eigen::Vector2d(140.5, -970)));
  for (const char* text : {"1 2 3", "1 2 3 4 5", "1 2 3 x", "5 0 4 1", "0 0 1 0", "a"})
  {
    options.area = text;
    const std::string message = messageOfError<UserError>([&] { validate(options, "map_export"); });
    EXPECT_NE(message.find("area = " + options.area + ": four numbers are needed"),
              std::string::npos)
        << message;
  }
}

TEST(MapExport, EmptyMapGivesValidFiles)
{
  const TestFolder folder;
  const test::TestMap held;
  const StaticMap& map = held.map;
  writeMapCloud(map.points(), folder.file("e.ply"));
  EXPECT_EQ(readCloud(folder.file("e.ply")).size(), 0U);
  writeMapCloud(map.points(), folder.file("e.pcd"));
  EXPECT_EQ(readCloud(folder.file("e.pcd")).size(), 0U);
  writeSimplemap(map, folder.file("e.simplemap"));
  mrpt::maps::CSimpleMap back;
  EXPECT_TRUE(back.loadFromFile(folder.file("e.simplemap")));
  EXPECT_EQ(back.size(), 0U);
  writeOctomap(map, folder.file("e.bt"), {});
  octomap::OcTree tree(0.2);
  EXPECT_TRUE(tree.readBinary(folder.file("e.bt")));
  EXPECT_EQ(tree.size(), 0U);
  writeOccupancyGrid(map, folder.file("e.png"), {});
  EXPECT_EQ(cv::imread(folder.file("e.png"), cv::IMREAD_UNCHANGED).total(), 1U);
}

TEST(MapExport, AFullDiskLeavesTheEarlierFiles)
{
  const TestFolder folder;
  const MapPoints points = test::room().map.points();
  for (const char* name : {"f.simplemap", "f.las", "f.pcd", "f.gridmap"})
  {
    std::ofstream(folder.file(name)) << "an earlier one";
  }
  {
    // Few bytes are written by the close only.
    const test::FullDisk full_disk(10);
    EXPECT_THROW(writeSimplemap(test::TestMap().map, folder.file("f.simplemap")), UserError);
    EXPECT_THROW(writeMapCloud(points, folder.file("f.las")), UserError);
    EXPECT_THROW(writeMapCloud({}, folder.file("f.pcd")), UserError);
    EXPECT_THROW(writeOccupancyGrid(test::TestMap().map, folder.file("f.gridmap"), {}), UserError);
  }
  for (const char* name : {"f.simplemap", "f.las", "f.pcd", "f.gridmap"})
  {
    EXPECT_EQ(folder.read(name), "an earlier one") << name;
    EXPECT_FALSE(std::filesystem::exists(folder.file(name) + ".tmp")) << name;
  }
}

TEST(MapExport, UnwritableFoldersAreErrors)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  const std::string nowhere = folder.file("no/such/folder/m");
  EXPECT_THROW(writeMapCloud(map.points(), nowhere + ".ply"), UserError);
  EXPECT_THROW(writeSimplemap(map, nowhere + ".simplemap"), UserError);
  EXPECT_THROW(writeOctomap(map, nowhere + ".bt", {}), UserError);
  EXPECT_THROW(writeOccupancyGrid(map, nowhere + ".png", {}), UserError);
}

TEST(MapExportOptions, CoordinatesAreNotOfAnotherZoneThanTheNumberStates)
{
  for (const auto& [given, of_coordinates] : {std::pair(0, 32632),
                                              {32632, 32632},
                                              {25832, 32632},  // ETRS89
                                              {32632, 0}})
  {
    EXPECT_NO_THROW(requireZone(given, of_coordinates)) << given;
  }
  EXPECT_EQ(
      "map_export.epsg = 32632: the coordinates are in 32733, by georeference.ini; leave it out, "
      "or --set map_export.epsg=0",
      messageOfError<UserError>([] { requireZone(32632, 32733); }));
}

TEST(MapExportOptions, TilesAreNotTooSmallAndHaveWholeCorners)
{
  const auto loaded = [](const std::string& tile_size)
  {
    MapExportOptions options;
    load(options, Config::fromText("[map_export]\ntile_size = " + tile_size + "\n", "test.ini"),
         "map_export");
    return options.tile_size;
  };
  EXPECT_EQ(0, loaded("0"));
  EXPECT_EQ(5, loaded("5"));
  EXPECT_EQ(250, loaded("250.0"));
  EXPECT_THROW((void)loaded("4.9"), UserError);
  const auto said = [&](const std::string& size)
  { return messageOfError<UserError>([&] { (void)loaded(size); }); };
  const std::string advice = ": use a whole number of metres, at least 5, or 0 for one file";
  EXPECT_EQ("[map_export] tile_size = 0.01" + advice, said("0.01")) << "millions of tiles";
  EXPECT_EQ("[map_export] tile_size = 12.5" + advice, said("12.5")) << "no corners of Autoware";
}
}  // namespace
}  // namespace dyslam
