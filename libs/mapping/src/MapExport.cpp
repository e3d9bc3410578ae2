// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapping/MapExport.h>

#include <array>
#include <filesystem>
#include <utility>
#include <vector>

namespace dyslam
{
void MapExportOptions::describe(OptionsVisitor& v)
{
  v.real("octree_resolution", octree_resolution, 0.01, 10, "m, side of octomap's leaves");
  v.real("octree_range", octree_range, 1, 300, "m, rays are cut off here");
  v.real("grid_resolution", grid_resolution, 0.01, 10, "m, side of the occupancy grid's cells");
  v.real("obstacle_min_height", obstacle_min_height, -10, 100,
         "m over the ground, lower things can be driven over");
  v.real("obstacle_max_height", obstacle_max_height, -10, 100,
         "m over the ground, higher things can be driven under");
  v.integer("grid_max_cells", grid_max_cells, 100, 2000000000, "a larger grid gets coarser cells");
}

void writeMapCloud(const MapPoints& points, const std::string& path)
{
  if (mapFormatOf(path) == MapFormat::pcd)
  {
    writePcd(path, points.points, points.intensity);
  }
  else if (mapFormatOf(path) == MapFormat::ply)
  {
    writePly(path, points.points, points.intensity);
  }
  else
  {
    throw UserError(path + ": a map's points are written as .pcd or .ply");
  }
}

MapFormat mapFormatOf(const std::string& path)
{
  constexpr std::array<std::pair<const char*, MapFormat>, 7> formats{
      {{".pcd", MapFormat::pcd},
       {".ply", MapFormat::ply},
       {".bt", MapFormat::octree},
       {".ot", MapFormat::octree},
       {".simplemap", MapFormat::simplemap},
       {".3Dscene", MapFormat::scene},
       {".png", MapFormat::grid}}};
  const std::string ending = std::filesystem::path(path).extension().string();
  std::vector<std::string> known;
  for (const auto& [name, format] : formats)
  {
    if (ending == name)
    {
      return format;
    }
    known.emplace_back(name);
  }
  const std::string near = nearestWord(ending, known);
  throw UserError(path + ": the ending is none of .pcd .ply .bt .ot .simplemap .3Dscene .png" +
                  (near.empty() || ending.empty() ? "" : "; did you mean " + near + "?"));
}
}  // namespace dyslam
