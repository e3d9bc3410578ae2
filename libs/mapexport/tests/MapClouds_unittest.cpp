// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapexport/MapClouds.h>
#include <dyslam/mapping/FullResolution.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "TestFolder.h"
#include "TestMap.h"
#include "WalledStreet.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

using PlaceList = std::vector<std::array<float, 3>>;

PlaceList sorted(const std::vector<Eigen::Vector3f>& points)
{
  PlaceList places;
  for (const auto& p : points)
  {
    places.push_back({p.x(), p.y(), p.z()});
  }
  std::sort(places.begin(), places.end());
  return places;
}

/** A map of a street, with the scans that it is made of, and a folder for its files. */
class MapCloudsTest : public testing::Test
{
 protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("dyslam_clouds_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    options_.max_range = 30;
    options_.visibility_range = 30;
    map_ = std::make_unique<test::TestMap>(options_);
    scans_ = std::make_unique<ScanStore>(file("scans"), options_);
    for (std::size_t k = 0; k < count; ++k)
    {
      const Frame frame = test::streetScan(k);
      map_->insert(frame);
      scans_->add(frame);
    }
  }
  void TearDown() override
  {
    scans_.reset();
    fs::remove_all(folder_);
  }

  [[nodiscard]] std::string file(const std::string& name) const
  {
    return (folder_ / name).string();
  }
  [[nodiscard]] MapClouds clouds() { return {options_, exports_, origin_, pool_}; }
  [[nodiscard]] PlaceList read(const std::string& name) const
  {
    return sorted(readCloud(file(name)).points);
  }
  /** Points of all tiles `NAME_X_Y.ply`. */
  [[nodiscard]] PlaceList readTiles(const std::string& name) const
  {
    std::vector<Eigen::Vector3f> points;
    for (const auto& entry : fs::directory_iterator(folder_))
    {
      const std::string path = entry.path().string();
      if (entry.path().filename().string().rfind(name + "_", 0) == 0)
      {
        const Scan tile = readCloud(path);
        EXPECT_FALSE(tile.points.empty()) << path;
        points.insert(points.end(), tile.points.begin(), tile.points.end());
      }
    }
    return sorted(points);
  }

  static constexpr std::size_t count = 12;
  fs::path folder_;
  StaticMapOptions options_;
  MapExportOptions exports_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  ThreadPool pool_{2};
  std::unique_ptr<test::TestMap> map_;
  std::unique_ptr<ScanStore> scans_;
};

TEST_F(MapCloudsTest, EveryFileHasThePointsOfTheMap)
{
  for (const bool normals : {true, false})
  {
    exports_.normals = normals;
    std::size_t last = 0;
    const std::size_t points = clouds().write(map_->map, nullptr, {file("a.ply"), file("a.pcd")},
                                              [&](std::size_t done) { last = done; });
    const PlaceList expected = sorted(map_->map.points().points);
    EXPECT_EQ(expected.size(), points);
    EXPECT_EQ(expected, read("a.ply"));
    EXPECT_EQ(expected, read("a.pcd"));
    EXPECT_EQ(count, last);
  }
}

TEST_F(MapCloudsTest, AFileThatCannotBeWrittenDoesNotKeepTheOthersFromBeingWritten)
{
  fs::create_directories(file("a.ply"));
  const auto said = [&](const std::vector<std::string>& paths)
  { return messageOfError<UserError>([&] { (void)clouds().write(map_->map, nullptr, paths); }); };
  EXPECT_EQ(file("a.ply") + ": is a folder, give the name of a file",
            said({file("a.ply"), file("a.pcd")}));
  EXPECT_EQ(sorted(map_->map.points().points), read("a.pcd"));
  fs::create_directories(file("b.las"));
  EXPECT_TRUE(contains(said({file("a.ply"), file("b.las")}), "b.las: is a folder"));
}

TEST_F(MapCloudsTest, FullResolutionHasEveryStaticPoint)
{
  exports_.full_resolution = true;
  const MapPoints points = map_->map.points();
  const FullResolution full(map_->map, options_, points);
  std::vector<Eigen::Vector3f> all;
  for (std::size_t k = 0; k < count; ++k)
  {
    const auto part = full.of(test::streetScan(k)).points;
    all.insert(all.end(), part.begin(), part.end());
  }
  std::vector<std::size_t> progress;
  EXPECT_EQ(all.size(), clouds().write(map_->map, scans_.get(), {file("full.ply")},
                                       [&](std::size_t done) { progress.push_back(done); }));
  EXPECT_EQ(sorted(all), read("full.ply"));
  ASSERT_EQ(count, progress.size());
  EXPECT_EQ(1U, progress.front());
  EXPECT_EQ(count, progress.back());
  EXPECT_THROW((void)clouds().write(map_->map, nullptr, {file("none.ply")}), std::invalid_argument);
}

TEST_F(MapCloudsTest, TilesTogetherAreTheMap)
{
  exports_.tile_size = 16;
  std::vector<std::array<std::size_t, 3>> progress;
  const std::size_t points =
      clouds().writeTiles(*scans_, {file("t.ply"), file("t.pcd")},
                          [&](std::size_t done, std::size_t all, std::size_t written) {
                            progress.push_back({done, all, written});
                          });
  const PlaceList expected = sorted(map_->map.points().points);
  EXPECT_EQ(expected.size(), points);
  std::size_t files = 0;
  fs::create_directories(folder_ / "pcd");
  for (const auto& entry : fs::directory_iterator(folder_))
  {
    if (entry.path().extension() == ".pcd")
    {
      fs::rename(entry.path(), folder_ / "pcd" / entry.path().filename());
      ++files;
    }
  }
  EXPECT_EQ(expected, readTiles("t"));
  EXPECT_FALSE(fs::exists(file("t.ply"))) << "tiles alone are written";
  ASSERT_FALSE(progress.empty());
  EXPECT_EQ(progress.size(), progress.back()[0]);
  EXPECT_EQ(progress.size(), progress.back()[1]);
  EXPECT_EQ(files, progress.back()[2]) << "tiles without points have no file";
  // Full resolution is that of the whole map, too.
  exports_.full_resolution = true;
  (void)clouds().write(map_->map, scans_.get(), {file("whole.ply")});
  (void)clouds().writeTiles(*scans_, {file("f.ply")});
  EXPECT_EQ(read("whole.ply"), readTiles("f"));
}

/** The same points as a whole, in tiles, and of full resolution. */
TEST_F(MapCloudsTest, AnAreaLimitsTheClouds)
{
  origin_ = {1000, 2000, 0};
  exports_.area = "1003 1994 1021.5 2004";
  MapRegion area;
  area.low = {3, -6};
  area.high = {21.5, 4};
  const PlaceList expected = sorted(pointsWithin(map_->map.points(), area).points);
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(expected.size(), clouds().write(map_->map, nullptr, {file("a.pcd")}));
  EXPECT_EQ(expected, read("a.pcd"));
  exports_.tile_size = 8;
  EXPECT_EQ(expected.size(), clouds().writeTiles(*scans_, {file("t.ply")}));
  exports_.full_resolution = true;
  EXPECT_GE(clouds().write(map_->map, scans_.get(), {file("full.pcd")}), expected.size());
  area.high.array() += 1e-3;  // rounded to float32
  for (const auto& place : read("full.pcd"))
  {
    ASSERT_TRUE(area.contains({place[0], place[1], place[2]}));
  }
}

TEST_F(MapCloudsTest, TheIndexHasTheCornerOfEveryTile)
{
  exports_.tile_size = 16;
  exports_.normals = false;
  origin_ = Eigen::Vector3d(456000, -1000, 0);
  (void)clouds().writeTiles(*scans_, {file("map.las"), file("map.pcd")});
  EXPECT_NE(readWhole(file("map.pcd.tiles.yaml")).find("map_1_-1.pcd: [16, -16]\n"),
            std::string::npos)
      << "relative to the origin, as its points";
  const std::string index = readWhole(file("map.las.tiles.yaml"));
  EXPECT_EQ(0U, index.find("x_resolution: 16\ny_resolution: 16\n")) << index;
  EXPECT_NE(index.find("map_1_-1.las: [456016, -1016]\n"), std::string::npos) << index;
  std::size_t tiles = 0;
  for (const auto& entry : fs::directory_iterator(folder_))
  {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".las")
    {
      ++tiles;
      EXPECT_NE(index.find("\n" + name + ": "), std::string::npos) << name;
    }
  }
  EXPECT_EQ(static_cast<std::ptrdiff_t>(tiles) + 2, std::count(index.begin(), index.end(), '\n'));
}

TEST_F(MapCloudsTest, TheIndexQuotesNamesThatYamlWouldReadOtherwise)
{
  exports_.tile_size = 16;
  exports_.normals = false;
  (void)clouds().writeTiles(*scans_, {file("#a: b.ply")});
  const std::string index = readWhole(file("#a: b.ply.tiles.yaml"));
  EXPECT_NE(index.find("\n\"#a: b_1_-1.ply\": [16, -16]\n"), std::string::npos) << index;
  exports_.tile_size = 64;
  (void)clouds().writeTiles(*scans_, {file("#a: b.ply")});
  EXPECT_EQ(sorted(map_->map.points().points), readTiles("#a: b")) << "earlier tiles are removed";
}

TEST_F(MapCloudsTest, TilesOfAnEarlierMapAreRemovedAndNothingElse)
{
  exports_.normals = false;
  exports_.tile_size = 16;
  (void)clouds().writeTiles(*scans_, {file("t.ply")});
  const std::size_t before = readTiles("t").size();
  fs::create_directories(folder_ / "t");
  const std::vector<std::string> others = {"notes.ply",     "t_7.ply",     "t_07_1.ply",
                                           "t_7_1_2.ply",   "t_7_1.pcd",   "t_7_1.ply.txt",
                                           "other_7_1.ply", "t/t_7_1.ply", "t_unlisted_7.ply"};
  std::ofstream index(file("t.ply.tiles.yaml"), std::ios::app);
  for (const std::string& name : others)
  {
    index << name << ": [112, 16]\n";
    writeWhole(file(name), "another's");
  }
  index << "t_70_1.ply: [0, 0]\n";  // of our naming, but a folder
  index.close();
  fs::create_directories(folder_ / "t_70_1.ply");
  writeWhole(file("t_71_1.ply"), "another's");  // of our naming, but not listed

  exports_.tile_size = 64;
  EXPECT_EQ(before, clouds().writeTiles(*scans_, {file("t.ply")}));
  for (const std::string& name : others)
  {
    EXPECT_TRUE(fs::exists(file(name))) << name;
  }
  EXPECT_TRUE(fs::remove(folder_ / "t_70_1.ply"));
  EXPECT_TRUE(fs::remove(folder_ / "t_71_1.ply"));
  for (const std::string& name : others)
  {
    fs::remove(folder_ / name);
  }
  EXPECT_EQ(before, readTiles("t").size()) << "each point is in one tile";
}

TEST_F(MapCloudsTest, AFolderThatIsMissingIsNamed)
{
  EXPECT_THROW((void)clouds().write(map_->map, nullptr, {file("no/a.ply")}), UserError);
  exports_.tile_size = 16;
  EXPECT_THROW((void)clouds().writeTiles(*scans_, {file("no/a.ply")}), UserError);
}

TEST_F(MapCloudsTest, AnEmptyMapIsAValidFile)
{
  const test::TestMap empty(options_);
  EXPECT_EQ(0U, clouds().write(empty.map, nullptr, {file("empty.ply")}));
  EXPECT_TRUE(read("empty.ply").empty());
  exports_.tile_size = 16;
  ScanStore none(file("none"), options_);
  EXPECT_EQ(0U, clouds().writeTiles(none, {file("empty.las")}));
  EXPECT_TRUE(fs::exists(file("empty.las.tiles.yaml")));
}

TEST_F(MapCloudsTest, ThinnedFullResolutionHasAPointPerCube)
{
  exports_.full_resolution = true;
  (void)clouds().write(map_->map, scans_.get(), {file("full.ply")});
  const PlaceList full = read("full.ply");
  constexpr double spacing = 0.5;
  const MapPoints thin = thinnedFullResolution(map_->map, options_, *scans_, spacing);
  EXPECT_LT(thin.size(), full.size() / 2);
  EXPECT_EQ(thin.size(), thin.intensity.size());
  const auto cubeOf = [](float x, float y, float z)
  {
    return std::array<int, 3>{static_cast<int>(std::floor(x / spacing)),
                              static_cast<int>(std::floor(y / spacing)),
                              static_cast<int>(std::floor(z / spacing))};
  };
  std::vector<std::array<int, 3>> cubes;
  for (const auto& [x, y, z] : full)
  {
    cubes.push_back(cubeOf(x, y, z));
  }
  std::sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  std::vector<std::array<int, 3>> found;
  for (const auto& p : thin.points)
  {
    found.push_back(cubeOf(p.x(), p.y(), p.z()));
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(cubes, found);
}
}  // namespace
}  // namespace dyslam
