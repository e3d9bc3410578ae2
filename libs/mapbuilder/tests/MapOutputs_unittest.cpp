// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/mapbuilder/MapOutputs.h>
#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
TEST(MapOutputs, FilesAreBesideTheFirstOutput)
{
  MapOutputs outputs;
  EXPECT_EQ("", outputs.beside("_tum.txt"));
  outputs.labelled_map = "l/truth.ply";
  EXPECT_EQ("", outputs.settingsFile());
  outputs.comparison = "c/both.png";
  EXPECT_EQ("c/both_tum.txt", outputs.beside("_tum.txt"));
  outputs.picture = "p/map.png";
  EXPECT_EQ("p/map.effective.ini", outputs.settingsFile());
  outputs.maps = {"m/a.las", "m/b.ply"};
  EXPECT_EQ("m/a.effective.ini", outputs.settingsFile());
}

TEST(MapOutputs, CloudsInTilesNeedNoWholeMap)
{
  MapOutputs outputs;
  outputs.maps = {"a.las", "b.ply"};
  EXPECT_TRUE(outputs.needWholeMap());
  outputs.exports.tile_size = 50;
  EXPECT_FALSE(outputs.needWholeMap());
  for (const char* other : {"c.bt", "c.png", "c.simplemap", "c.3Dscene", "c.gridmap"})
  {
    MapOutputs more = outputs;
    more.maps.emplace_back(other);
    EXPECT_TRUE(more.needWholeMap()) << other;
  }
  for (std::string MapOutputs::*picture : {&MapOutputs::picture, &MapOutputs::comparison})
  {
    MapOutputs more = outputs;
    more.*picture = "p.png";
    EXPECT_TRUE(more.needWholeMap());
  }
}

TEST(MapOutputs, ALabelledMapAloneNeedsNoMap)
{
  MapOutputs outputs;
  outputs.labelled_map = "truth.ply";
  EXPECT_FALSE(outputs.needWholeMap());
  outputs.maps = {"a.las"};
  EXPECT_TRUE(outputs.needWholeMap());
}

TEST(MapOutputs, TilesAndFullResolutionNeedTheScans)
{
  MapOutputs outputs;
  outputs.maps = {"a.bt", "b.ply"};
  EXPECT_FALSE(outputs.needScans());
  outputs.exports.tile_size = 50;
  EXPECT_TRUE(outputs.needScans());
  outputs.exports.tile_size = 0;
  outputs.exports.full_resolution = true;
  EXPECT_TRUE(outputs.needScans());
  outputs.maps = {"a.3Dscene"};
  EXPECT_TRUE(outputs.needScans());
  outputs.maps = {"a.bt", "a.png"};
  EXPECT_FALSE(outputs.needScans()) << "only clouds and scenes have a full resolution";
  outputs.maps = {"a.xyz"};
  EXPECT_THROW((void)outputs.needScans(), UserError);
}
}  // namespace
}  // namespace dyslam
