// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/mapexport/MapExport.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double smallest_tile = 5;  // [m]; a scan would reach millions of tiles that are too small

/** \throws UserError for tiles that are too small, or whose corners are no whole metres: those are
 * what Autoware's map loader reads. */
void requireTileSize(double size)
{
  if (size == 0 || (size >= smallest_tile && size == std::floor(size)))
  {
    return;
  }
  throw UserError(
      formatted("[map_export] tile_size = %g: use a whole number of metres, at least %g, or 0 for "
                "one file",
                size, smallest_tile));
}

/** Whether a number is that of a zone of UTM (WGS84). */
bool isZone(int epsg)
{
  constexpr int zones = 60;
  constexpr int north = 32600;
  constexpr int south = 32700;
  return (epsg > north && epsg <= north + zones) || (epsg > south && epsg <= south + zones);
}
}  // namespace

void requireZone(int epsg, int of_coordinates)
{
  if (isZone(epsg) && isZone(of_coordinates) && epsg != of_coordinates)
  {
    throw UserError("map_export.epsg = " + std::to_string(epsg) + ": the coordinates are in " +
                    std::to_string(of_coordinates) +
                    ", by georeference.ini; leave it out, or --set map_export.epsg=0");
  }
}

MapRegion areaOf(const MapExportOptions& options, const Eigen::Vector3d& origin)
{
  MapRegion region;
  if (options.area.empty())
  {
    return region;
  }
  std::string text = options.area;
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double number = 0; words >> number;)
  {
    numbers.push_back(number);
  }
  if (!words.eof() || numbers.size() != 4 || numbers[0] >= numbers[2] || numbers[1] >= numbers[3])
  {
    throw UserError("[map_export] area = " + options.area +
                    ": four numbers are needed: x_min y_min x_max y_max [m]");
  }
  region.low = Eigen::Vector2d(numbers[0], numbers[1]) - origin.head<2>();
  region.high = Eigen::Vector2d(numbers[2], numbers[3]) - origin.head<2>();
  return region;
}

void MapExportOptions::describe(OptionsVisitor& v)
{
  v.flag("full_resolution", full_resolution,
         "write clouds with every static point, not one per voxel");
  v.flag("normals", normals, "write clouds with normals, which point towards the sensor");
  v.real("normal_radius", normal_radius, 0.01, 100, "radius of the neighbourhood of a normal [m]");
  v.integer(
      "epsg", epsg, 0, 32767,
      "number of the coordinate reference system (EPSG) of the trajectory, which .las files state; "
      "0: none");
  v.real("tile_size", tile_size, 0, 100000,
         "side of the tiles in which clouds are written, whole and at least 5; 0: one file [m]");
  requireTileSize(tile_size);
  v.real("octree_resolution", octree_resolution, 0.01, 10, "side of the octree's leaves [m]");
  v.real("octree_range", octree_range, 1, 300,
         "range at which rays into the octree are cut off [m]");
  v.real("grid_resolution", grid_resolution, 0.01, 10, "side of the occupancy grid's cells [m]");
  v.real("obstacle_min_height", obstacle_min_height, -10, 100,
         "height above ground up to which objects can be driven over [m]");
  v.real("obstacle_max_height", obstacle_max_height, -10, 100,
         "height above ground from which objects can be driven under [m]");
  if (obstacle_min_height >= obstacle_max_height)
  {
    throw UserError("[map_export] obstacle_min_height must be below obstacle_max_height");
  }
  v.integer(
      "obstacle_min_hits", obstacle_min_hits, 1, 1000,
      "least number of keyframes that observed an obstacle; 1: ghosts of moving objects stay");
  v.integer("grid_max_cells", grid_max_cells, 100, 2000000000,
            "upper limit of the occupancy grid's cells; a larger grid gets coarser cells");
  v.text("area", area,
         "part of the map that is written: x_min y_min x_max y_max, in the coordinates of the "
         "trajectory; empty: all of it [m]");
  (void)areaOf(*this);
}
}  // namespace dyslam
