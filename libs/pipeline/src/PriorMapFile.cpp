// SPDX-License-Identifier: BSD-3-Clause
#include "PriorMapFile.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr float farthest = 50000;           // largest coordinate [m]: float32 resolves 4 mm there
constexpr std::size_t least_points = 1000;  // of a map in which a vehicle finds its way

/** The cloud itself, or that in the output folder of a run. */
std::string cloudOf(const std::string& path)
{
  if (!fs::exists(path))
  {
    throw UserError("prior_map.file: " + path + ": no such file or folder");
  }
  if (!fs::is_directory(path))
  {
    return path;
  }
  const std::string map = staticMapOfRun(path);
  if (map.empty())
  {
    throw UserError("prior_map.file: " + path +
                    ": has no map_static.pcd or map_static.ply; give a map file, which dyslam-map "
                    "--run " +
                    path + " -o map.pcd writes");
  }
  return map;
}
}  // namespace

std::vector<Eigen::Vector3f> readPriorMap(const PriorMapOptions& options)
{
  if (options.file.empty())
  {
    return {};
  }
  const std::string path = cloudOf(options.file);
  const std::string ending = lowerExtension(path);
  if (ending != ".pcd" && ending != ".ply")
  {
    throw UserError("prior_map.file: " + path + ": is no .pcd or .ply");
  }
  std::vector<Eigen::Vector3f> points =
      namingSetting("prior_map.file", path, [&] { return readCloud(path).points; });
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const Eigen::Vector3f& p) { return !p.allFinite(); }),
               points.end());
  if (points.size() < least_points)
  {
    throw UserError("prior_map.file: " + path + ": has " + counted(points.size(), "point") +
                    ", which is no map of a place");
  }
  if (std::any_of(points.begin(), points.end(),
                  [](const Eigen::Vector3f& p) { return p.cwiseAbs().maxCoeff() > farthest; }))
  {
    throw UserError(
        "prior_map.file: " + path +
        ": has coordinates of more than 50 km; give a map in metres, in the map frame of its "
        "run and not in UTM");
  }
  return points;
}
}  // namespace dyslam
