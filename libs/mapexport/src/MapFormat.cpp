// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/mapexport/MapFormat.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "CloudFormat.h"

namespace dyslam
{
namespace
{
constexpr const char* cloud_help = "clouds";
constexpr const char* octree_help = "octomap, binary or full";

/** One row per format. */
constexpr std::array<MapFormat, 9> map_formats{
    {{".pcd", MapKind::cloud, makePcdFormat, false, true, cloud_help},
     {".ply", MapKind::cloud, makePlyFormat, true, true, cloud_help},
     {".las", MapKind::cloud, makeLasFormat, true, true, cloud_help},
     {".bt", MapKind::octree, nullptr, false, false, octree_help},
     {".ot", MapKind::octree, nullptr, false, false, octree_help},
     {".simplemap", MapKind::simplemap, nullptr, true, false, "keyframes for MRPT"},
     {".3Dscene", MapKind::scene, nullptr, false, true, "scene for SceneViewer3D"},
     {".png", MapKind::grid, nullptr, true, false, "occupancy grid with its .yaml for ROS"},
     {".gridmap", MapKind::grid, nullptr, false, false, "occupancy grid for MRPT"}}};
}  // namespace

std::vector<MapFormat> mapFormats()
{
  return {map_formats.begin(), map_formats.end()};
}

MapFormat mapFormatOf(const std::string& path)
{
  const std::string ending = std::filesystem::path(path).extension().string();
  const auto* const found =
      std::find_if(map_formats.begin(), map_formats.end(),
                   [&ending](const MapFormat& format) { return ending == format.ending; });
  if (found != map_formats.end())
  {
    return *found;
  }
  if (ending == ".laz")
  {
    throw UserError(path + ": compressed LAS is not written; give .las and compress it after");
  }
  if (ending == ".pgm" || ending == ".yaml")
  {
    throw UserError(path + ": give the occupancy grid as .png; its .yaml is written beside it");
  }
  std::vector<std::string> known;
  for (const MapFormat& format : map_formats)
  {
    known.emplace_back(format.ending);
  }
  throw UserError(path + ": " + unknownWord("ending", ending, known));
}

std::string mapFormatsHelp()
{
  std::string help;
  std::vector<std::string> endings;  // of rows with the same text
  for (std::size_t i = 0; i < map_formats.size(); ++i)
  {
    const std::string text = map_formats[i].help;
    endings.emplace_back(map_formats[i].ending + 1);
    if (i + 1 < map_formats.size() && text == map_formats[i + 1].help)
    {
      continue;
    }
    const std::string names =
        endings.size() == 1 ? endings.front() : "{" + joined(endings, ",") + "}";
    appendWord(help, "map." + names + ": " + text, "; ");
    endings.clear();
  }
  return help;
}
}  // namespace dyslam
