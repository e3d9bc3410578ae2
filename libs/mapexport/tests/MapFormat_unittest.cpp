// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/mapexport/MapFormat.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <string>

#include "TestFolder.h"
#include "TestRoom.h"

namespace dyslam
{
namespace
{
TEST(MapFormats, AreFoundByTheirEndings)
{
  std::set<std::string> endings;
  for (const MapFormat& format : mapFormats())
  {
    EXPECT_TRUE(endings.insert(format.ending).second) << format.ending;
    EXPECT_STREQ(mapFormatOf(std::string("a.b/map") + format.ending).ending, format.ending);
    EXPECT_EQ(format.make_cloud != nullptr, format.kind == MapKind::cloud) << format.ending;
  }
  EXPECT_EQ(mapFormatOf("map.ot").kind, MapKind::octree);
  EXPECT_EQ(mapFormatOf("map.gridmap").kind, MapKind::grid);
}

TEST(MapFormats, OtherEndingsAreErrorsWithAdvice)
{
  const auto messageFor = [](const std::string& path)
  { return messageOfError<UserError>([&path] { (void)mapFormatOf(path); }); };
  EXPECT_TRUE(contains(messageFor("map.3dscene"), "did you mean '.3Dscene'"));
  EXPECT_TRUE(contains(messageFor("grid.pgm"), "grid as .png"));
  EXPECT_TRUE(contains(messageFor("map.laz"), "give .las"));
  EXPECT_TRUE(contains(messageFor("map"), "unknown ending ''"));
  const TestFolder folder;
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] { writeMapCloud(test::room().map.points(), folder.file("m.bt")); }),
                       "m.bt: is no cloud: .bt is for octomap"));
}

TEST(MapFormats, CoordinatesContainTheOriginWhereTheTableSaysSo)
{
  const TestFolder folder;
  MapPoints points;
  points.points = {{1, 2, 3}};
  points.intensity = {0.5F};
  std::size_t compared = 0;
  for (const MapFormat& format : mapFormats())
  {
    const std::string path = folder.file(std::string("m") + format.ending);
    if (format.kind != MapKind::cloud || !isCloudFile(path))  // .las has a test of its own
    {
      continue;
    }
    writeMapCloud(points, path, Eigen::Vector3d(4000, 0, 0));
    const Scan back = readCloud(path);
    ASSERT_EQ(back.size(), 1U);
    EXPECT_EQ(back.points[0].x(), format.holds_origin ? 4001 : 1) << format.ending;
    ++compared;
  }
  EXPECT_EQ(compared, 2U);
}

TEST(MapFormats, TheHelpListsEachEndingOnce)
{
  const std::string help = mapFormatsHelp();
  EXPECT_EQ(help.rfind("map.{pcd,ply,las}: clouds; map.{bt,ot}: octomap", 0), 0U) << help;
  EXPECT_TRUE(contains(help, "; map.png: occupancy grid with its .yaml for ROS; ")) << help;
}
}  // namespace
}  // namespace dyslam
