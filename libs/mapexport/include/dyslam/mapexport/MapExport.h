// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/mapping/StaticMap.h>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string>

// The static map as files. Every writer throws UserError where the file cannot be written, and
// renames it to its final name when it is complete. The same map gives the same bytes. An empty map
// gives a valid file without points. `origin` is the origin of the map frame in the coordinates of
// the file [m], for maps far from zero.

namespace dyslam
{
/** Ini section `[map_export]`. */
struct MapExportOptions : Options
{
  bool full_resolution = false;      //!< clouds with every static point, not one per voxel
  bool normals = true;               //!< clouds with normals
  double normal_radius = 0.8;        //!< radius of the neighbourhood of a normal [m]
  int epsg = 0;                      //!< EPSG number of the coordinates' system, for .las; 0: none
  double tile_size = 0;              //!< clouds in tiles of this side, whole metres; 0: one file
  double octree_resolution = 0.2;    //!< side of octomap's leaves [m]
  double octree_range = 40.0;        //!< range at which rays are cut off [m]
  double grid_resolution = 0.1;      //!< side of the occupancy grid's cells [m]
  double obstacle_min_height = 0.3;  //!< lower objects can be driven over [m]
  double obstacle_max_height = 2.2;  //!< higher objects can be driven under [m]
  int obstacle_min_hits = 2;         //!< least number of keyframes that observed an obstacle
  int grid_max_cells = 100000000;    //!< a larger grid gets coarser cells
  /** Part of the plane that is exported: x_min y_min x_max y_max, in the coordinates of the
   * trajectory [m]; empty: all of it. */
  std::string area;

  void describe(OptionsVisitor& visitor) override;
};

/** \param epsg as MapExportOptions::epsg \param of_coordinates number of the zone of UTM that the
 * coordinates are in; 0: not known \throws UserError if they name different zones of UTM (WGS84) */
void requireZone(int epsg, int of_coordinates);

/** MapExportOptions::area in the map frame. \param origin of the map frame in the coordinates of
 * the area [m] \throws UserError unless it is empty or four numbers in order */
[[nodiscard]] MapRegion areaOf(const MapExportOptions& options,
                               const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/** Called with the number of keyframes done after each of them; may be empty. */
using MapProgress = std::function<void(std::size_t)>;

/** Writes a MapCloudFile of the points, with normals if they have any. */
void writeMapCloud(const MapPoints& points,
                   const std::string& path,
                   const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/** Writes MRPT's CSimpleMap: pose and static points (CObservationPointCloud) of each keyframe.
 * \param area of which the points are, in the map frame; keyframes without one are left out, if it
 * is not the whole plane */
void writeSimplemap(const StaticMap& map,
                    const std::string& path,
                    const Eigen::Vector3d& origin = Eigen::Vector3d::Zero(),
                    const MapRegion& area = {},
                    const MapProgress& on_keyframe = {});

/** octomap's `.bt` (binary) or `.ot` (full): keyframes' static points and the rays to them, which
 * clear cells without a static point only. Has the cells whose centres are in the `area`. Stays
 * relative to the origin. \throws UserError for another ending, and for a map beyond the reach of
 * octomap's keys. */
void writeOctomap(const StaticMap& map,
                  const std::string& path,
                  const MapExportOptions& options,
                  const Eigen::Vector3d& origin = Eigen::Vector3d::Zero(),
                  const MapProgress& on_keyframe = {});

/** 2D occupancy grid for navigation: `x.gridmap` (MRPT's COccupancyGridMap2D, which stays relative
 * to the origin), or with any other ending a PNG, and `x.yaml` for ROS's map_server beside it. In a
 * grid finer than the voxels, obstacles in neighbouring columns of voxels are connected. With an
 * `area` the grid has that size, also where nothing was observed.
 * \return side of the cells [m], more than grid_resolution if there were more than grid_max_cells,
 * or more than a million in a row, which no PNG has */
double writeOccupancyGrid(const StaticMap& map,
                          const std::string& path,
                          const MapExportOptions& options,
                          const Eigen::Vector3d& origin = Eigen::Vector3d::Zero(),
                          const MapProgress& on_keyframe = {});

/** Whether the file exists and is the image of an occupancy grid: `x.png` that `x.yaml` names. */
[[nodiscard]] bool isGridImage(const std::string& path);
}  // namespace dyslam
