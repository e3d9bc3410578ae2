// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapexport/MapCloudFile.h>
#include <dyslam/mapexport/MapExport.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <octomap/OcTree.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "CloudFormat.h"
#include "FullDisk.h"
#include "TestMap.h"
#include "TestRoom.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class MapExport : public testing::Test
{
 protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("dyslam_map_export_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const
  {
    return (folder_ / name).string();
  }

  [[nodiscard]] static std::string bytes(const std::string& file)
  {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
  }

  fs::path folder_;
};

TEST_F(MapExport, CloudsRoundTrip)
{
  const auto points = test::room().map.points();
  ASSERT_GT(points.size(), 1000U);
  for (const std::string name : {"m.pcd", "m.ply"})
  {
    writeMapCloud(points, path(name));
    const Scan back = readCloud(path(name));
    ASSERT_EQ(back.size(), points.size());
    EXPECT_EQ(back.points, points.points);
    EXPECT_EQ(back.intensity, points.intensity);
    const auto first = bytes(path(name));
    writeMapCloud(points, path(name));
    EXPECT_EQ(bytes(path(name)), first);
  }
  EXPECT_THROW(writeMapCloud(points, path("m.xyz")), UserError);
}

template <typename T>
T numberAt(const std::string& bytes, std::size_t at)
{
  T value{};
  std::memcpy(&value, &bytes.at(at), sizeof value);
  return value;
}

/** By the offsets of the specifications: LAS 1.2, and 1.4 for the extra bytes. */
TEST_F(MapExport, LasIsAsSpecifiedAndExactFarFromZero)
{
  MapPoints points;
  points.points = {{1.0004F, -2, 0.5F}, {-70.25F, 900.125F, -3}, {0, 0, 0}};
  points.intensity = {0, 1, 0.5F};
  points.normals = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}};
  const Eigen::Vector3d origin(448000, 5428000, 0);
  writeMapCloud(points, path("m.las"), origin);
  const std::string las = bytes(path("m.las"));
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
TEST_F(MapExport, TheDateOfALasIsThatOfTheRecording)
{
  const auto dateOf = [&](std::optional<double> recorded)
  {
    MapCloudFile file(path("m.las"), {false, Eigen::Vector3d::Zero(), recorded, 0});
    file.close();
    const std::string las = bytes(path("m.las"));
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
TEST_F(MapExport, ALasStatesItsReferenceSystem)
{
  MapPoints points;
  points.points = {{1, 2, 3}};
  points.intensity = {0.5F};
  points.normals = {{0, 0, 1}};
  for (const bool normals : {false, true})
  {
    MapCloudFile file(path("m.las"), {normals, Eigen::Vector3d::Zero(), std::nullopt, 32632});
    file.add(points);
    file.close();
    const std::string las = bytes(path("m.las"));
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

TEST_F(MapExport, CloudsFarFromZeroKeepTheirPrecision)
{
  MapPoints points;
  points.points = {{1.25F, -2, 0.5F}};
  points.intensity = {0.5F};
  const Eigen::Vector3d origin(448000, 5428000, 0);
  writeMapCloud(points, path("m.ply"), origin);
  const std::string ply = bytes(path("m.ply"));
  const std::size_t data = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("property double x\n"), std::string::npos);
  EXPECT_EQ(numberAt<double>(ply, data), 448001.25);
  EXPECT_EQ(numberAt<double>(ply, data + 8), 5427998.0);
  writeMapCloud(points, path("m.pcd"), origin);
  EXPECT_EQ(readCloud(path("m.pcd")).points, points.points);
  EXPECT_NE(bytes(path("m.pcd")).find("VIEWPOINT 448000 5428000 0 1 0 0 0\n"), std::string::npos);
}

TEST_F(MapExport, ACloudWithNormalsNeedsThemOfAllPoints)
{
  MapPoints points;
  points.points = {{1, 2, 3}};
  points.intensity = {0.5F};
  MapCloudFile file(path("m.ply"), true);
  EXPECT_THROW(file.add(points), std::invalid_argument);
  points.normals = {{0, 0, 1}};
  file.add(points);
  EXPECT_EQ(file.count(), 1U);
  EXPECT_FALSE(fs::exists(path("m.ply"))) << "it is not closed";
  file.close();
  EXPECT_EQ(readCloud(path("m.ply")).points, points.points);
}

/** The point counts of LAS 1.2, and of PCL, which reads PCD, have 32 bits. */
TEST_F(MapExport, FormatsHoldAsManyPointsAsTheirReadersCount)
{
  constexpr std::uint64_t of_32_bits = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(makeLasFormat({})->maxPoints(), of_32_bits);
  EXPECT_EQ(makePcdFormat({})->maxPoints(), of_32_bits);
  EXPECT_GT(makePlyFormat({})->maxPoints(), of_32_bits);
}

TEST_F(MapExport, KeyframesAreCountedWhenTheyAreDone)
{
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
    switch (mapFormatOf(name))
    {
      case MapFormat::octree:
        writeOctomap(held.map, path(name), {}, count);
        break;
      case MapFormat::grid:
        writeOccupancyGrid(held.map, path(name), {}, Eigen::Vector3d::Zero(), count);
        break;
      default:
        writeSimplemap(held.map, path(name), Eigen::Vector3d::Zero(), count);
    }
    EXPECT_EQ(done, all) << name;
  }
}

TEST_F(MapExport, OctomapIsWhatItsOwnInsertionMakesButRaysDoNotClearThePointsOfTheMap)
{
  const test::TestMap held = test::room();
  MapExportOptions options;
  options.octree_range = 6.0;  // some rays are cut off
  writeOctomap(held.map, path("m.ot"), options);
  octomap::OcTree tree(options.octree_resolution);
  std::vector<octomap::Pointcloud> scans;
  octomap::KeySet is_static;
  const auto toOctomap = [&](std::size_t k, const Eigen::Vector3f& p)
  {
    const Eigen::Vector3f q = (held.map.poses()[k] * p.cast<double>()).cast<float>();
    return octomap::point3d(q.x(), q.y(), q.z());
  };
  held.map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        octomap::Pointcloud& points = scans.emplace_back();
        for (const auto& p : cloud.points)
        {
          points.push_back(toOctomap(k, p));
          is_static.insert(tree.coordToKey(toOctomap(k, p)));
        }
      });
  for (std::size_t k = 0; k < scans.size(); ++k)
  {
    octomap::KeySet free;
    octomap::KeySet occupied;
    tree.computeDiscreteUpdate(scans[k], toOctomap(k, held.map.keyframes()[k].sensor), free,
                               occupied, options.octree_range);
    for (const octomap::OcTreeKey& key : free)
    {
      if (is_static.count(key) == 0)
      {
        tree.updateNode(key, false, true);
      }
    }
    for (const octomap::OcTreeKey& key : occupied)
    {
      tree.updateNode(key, true, true);
    }
  }
  tree.updateInnerOccupancy();
  std::ostringstream expected;
  ASSERT_TRUE(tree.write(expected));
  EXPECT_EQ(bytes(path("m.ot")), expected.str());
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  writeOctomap(held.map, path("m.bt"), options);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  std::ostringstream binary;
  ASSERT_TRUE(tree.writeBinary(binary));
  EXPECT_EQ(bytes(path("m.bt")), binary.str());
}

TEST_F(MapExport, OctomapBeyondItsKeysIsAnError)
{
  test::TestMap map;
  Frame frame;
  frame.T_odom_vehicle = poseFromYpr(6540, 0, 0, 0, 0, 0);
  for (int i = 0; i < 100; ++i)
  {
    frame.cloud.points.emplace_back(5.0F + 0.3F * static_cast<float>(i), 0.0F, 0.0F);
    frame.cloud.source.push_back(0);
  }
  map.insert(frame);
  try
  {
    writeOctomap(map.map, path("m.bt"), {});
    FAIL() << "points were lost";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("octree_resolution=0.2; take 0.4"), std::string::npos)
        << error.what();
  }
  MapExportOptions coarser;
  coarser.octree_resolution = 0.4;
  writeOctomap(map.map, path("m.bt"), coarser);
  octomap::OcTree tree(0.4);
  ASSERT_TRUE(tree.readBinary(path("m.bt")));
  EXPECT_NE(tree.search(6540 + 20, 0, 0), nullptr);
}

TEST_F(MapExport, SimplemapHoldsPosesAndClouds)
{
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  writeSimplemap(map, path("m.simplemap"));
  const auto first = bytes(path("m.simplemap"));
  writeSimplemap(map, path("m.simplemap"));
  EXPECT_EQ(bytes(path("m.simplemap")), first);

  mrpt::maps::registerAllClasses_mrpt_maps();
  mrpt::maps::CSimpleMap back;
  ASSERT_TRUE(back.loadFromFile(path("m.simplemap")));
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

TEST_F(MapExport, SimplemapIsWhatMrptWouldWrite)
{
  mrpt::maps::registerAllClasses_mrpt_maps();
  writeSimplemap(test::room().map, path("a.simplemap"), {1000, 2000, 0});
  mrpt::maps::CSimpleMap map;
  ASSERT_TRUE(map.loadFromFile(path("a.simplemap")));
  std::vector<std::uint8_t> expected;
  mrpt::serialization::ObjectToOctetVector(&map, expected);
  mrpt::io::CFileGZInputStream file(path("a.simplemap"));
  std::vector<std::uint8_t> written(2 * expected.size());
  written.resize(file.Read(written.data(), written.size()));
  EXPECT_EQ(written, expected);
}

TEST_F(MapExport, OctomapKnowsOccupiedAndFree)
{
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  for (const std::string name : {"m.bt", "m.ot"})
  {
    writeOctomap(map, path(name), {});
    const auto first = bytes(path(name));
    writeOctomap(map, path(name), {});
    EXPECT_EQ(bytes(path(name)), first);
  }
  octomap::OcTree tree(0.2);
  ASSERT_TRUE(tree.readBinary(path("m.bt")));
  const auto* wall = tree.search(8.05, 0, 1.0);
  ASSERT_NE(wall, nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(wall));
  const auto* air = tree.search(4.0, 0, 1.3);
  ASSERT_NE(air, nullptr);
  EXPECT_FALSE(tree.isNodeOccupied(air));
  EXPECT_EQ(tree.search(12.0, 0, 1.0), nullptr);
  EXPECT_THROW(writeOctomap(map, path("m.oct"), {}), UserError);
}

/** From later places there are only rays past the post: its voxel has all points that it keeps. */
TEST_F(MapExport, OctomapKeepsAThinPostThatManyRaysPass)
{
  StaticMapOptions options;
  options.visibility = false;
  test::TestMap held(options);
  const Eigen::Vector3d post(5.1, 0.1, 1.1);
  for (std::size_t k = 0; k < 20; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.T_odom_vehicle = poseFromYpr(0, -0.4 * static_cast<double>(k), 1.1, 0, 0, 0);
    const Eigen::Vector3d sensor = frame.T_odom_vehicle.translation();
    const Eigen::Vector3d wall = sensor + 9.1 / 5.1 * (post - sensor);
    for (const Eigen::Vector3d& p : {post, wall})
    {
      frame.cloud.points.push_back((frame.T_odom_vehicle.inverse() * p).cast<float>());
      frame.cloud.intensity.push_back(0.25F);
      frame.cloud.source.push_back(0);
    }
    held.insert(frame);
  }
  writeOctomap(held.map, path("m.bt"), {});
  octomap::OcTree tree(0.2);
  ASSERT_TRUE(tree.readBinary(path("m.bt")));
  const auto* cell = tree.search(post.x(), post.y(), post.z());
  ASSERT_NE(cell, nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(cell));
  const auto* air = tree.search(2.5, -0.1, 1.1);
  ASSERT_NE(air, nullptr);
  EXPECT_FALSE(tree.isNodeOccupied(air));
}

TEST_F(MapExport, OctomapHasTheRaysOfEachLidar)
{
  writeOctomap(test::seenByTwoLidars().map, path("m.ot"), {});
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(path("m.ot")));
  const auto* tree = dynamic_cast<const octomap::OcTree*>(read.get());
  ASSERT_NE(tree, nullptr);
  const auto* air = tree->search(4.1, 5.15, 1.1);
  ASSERT_NE(air, nullptr) << "before the second lidar";
  EXPECT_FALSE(tree->isNodeOccupied(air));
  const auto* thing = tree->search(8.1, 5.15, 1.1);
  ASSERT_NE(thing, nullptr);
  EXPECT_FLOAT_EQ(thing->getLogOdds(), tree->getProbHitLog()) << "a miss of the other lidar";
}

TEST_F(MapExport, EmptyMapGivesValidFiles)
{
  const test::TestMap held;
  const StaticMap& map = held.map;
  writeMapCloud(map.points(), path("e.ply"));
  EXPECT_EQ(readCloud(path("e.ply")).size(), 0U);
  writeMapCloud(map.points(), path("e.pcd"));
  EXPECT_EQ(readCloud(path("e.pcd")).size(), 0U);
  writeSimplemap(map, path("e.simplemap"));
  mrpt::maps::CSimpleMap back;
  EXPECT_TRUE(back.loadFromFile(path("e.simplemap")));
  EXPECT_EQ(back.size(), 0U);
  writeOctomap(map, path("e.bt"), {});
  octomap::OcTree tree(0.2);
  EXPECT_TRUE(tree.readBinary(path("e.bt")));
  EXPECT_EQ(tree.size(), 0U);
  writeOccupancyGrid(map, path("e.png"), {});
  EXPECT_EQ(cv::imread(path("e.png"), cv::IMREAD_UNCHANGED).total(), 1U);
}

TEST_F(MapExport, AFullDiskLeavesTheEarlierFiles)
{
  const MapPoints points = test::room().map.points();
  for (const char* name : {"f.simplemap", "f.las", "f.pcd", "f.gridmap"})
  {
    std::ofstream(path(name)) << "an earlier one";
  }
  {
    // Few bytes are written by the close only.
    const test::FullDisk full_disk(10);
    EXPECT_THROW(writeSimplemap(test::TestMap().map, path("f.simplemap")), UserError);
    EXPECT_THROW(writeMapCloud(points, path("f.las")), UserError);
    EXPECT_THROW(writeMapCloud({}, path("f.pcd")), UserError);
    EXPECT_THROW(writeOccupancyGrid(test::TestMap().map, path("f.gridmap"), {}), UserError);
  }
  for (const char* name : {"f.simplemap", "f.las", "f.pcd", "f.gridmap"})
  {
    EXPECT_EQ(bytes(path(name)), "an earlier one") << name;
    EXPECT_FALSE(fs::exists(path(name) + ".tmp")) << name;
  }
}

TEST_F(MapExport, UnwritableFoldersAndBadEndings)
{
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  const std::string nowhere = path("no/such/folder/m");
  EXPECT_THROW(writeMapCloud(map.points(), nowhere + ".ply"), UserError);
  EXPECT_THROW(writeSimplemap(map, nowhere + ".simplemap"), UserError);
  EXPECT_THROW(writeOctomap(map, nowhere + ".bt", {}), UserError);
  EXPECT_THROW(writeOccupancyGrid(map, nowhere + ".png", {}), UserError);
  try
  {
    (void)mapFormatOf("map.3dscene");
    FAIL() << "a bad ending was accepted";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("did you mean '.3Dscene'"), std::string::npos)
        << error.what();
  }
  try
  {
    (void)mapFormatOf("grid.pgm");
    FAIL() << "a bad ending was accepted";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("grid as .png"), std::string::npos) << error.what();
  }
}

TEST(MapExportOptions, TilesAreNotTooSmall)
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
  EXPECT_THROW((void)loaded("4.9"), UserError);
  try
  {
    (void)loaded("0.01");
    FAIL() << "millions of tiles";
  }
  catch (const UserError& error)
  {
    EXPECT_STREQ(
        "[map_export] tile_size = 0.01 is too small; use at least 5 (m), or 0 for one file",
        error.what());
  }
}
}  // namespace
}  // namespace dyslam
