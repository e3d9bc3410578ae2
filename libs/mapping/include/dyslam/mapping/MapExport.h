// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <functional>
#include <string>

namespace dyslam
{
struct MapExportOptions : Options
{
  double octree_resolution = 0.2;    //!< side of octomap's leaves [m]
  double octree_range = 40.0;        //!< rays are cut off here [m]
  double grid_resolution = 0.1;      //!< side of the occupancy grid's cells [m]
  double obstacle_min_height = 0.3;  //!< over the ground: lower things can be driven over [m]
  double obstacle_max_height = 2.2;  //!< over the ground: higher things can be driven under [m]
  int grid_max_cells = 100000000;    //!< a larger grid gets coarser cells

  void describe(OptionsVisitor& visitor) override;
};

/** Every writer throws UserError where the file cannot be written; the file gets its name only when
 * it is whole. The same map gives the same bytes. An empty map gives a valid file without points.
 */

/** Map points as `.pcd` (binary; x y z intensity) or `.ply` (the same). */
void writeMapCloud(const MapPoints& points, const std::string& path);

/** MRPT's CSimpleMap: per keyframe its pose and the static points as CObservationPointCloud. */
void writeSimplemap(const StaticMap& map, const std::string& path);

/** octomap's `.bt` (binary) or `.ot` (full): keyframes' static points and the rays to them.
 * \param on_keyframe called with the number of keyframes done after each of them; may be empty. */
void writeOctomap(const StaticMap& map,
                  const std::string& path,
                  const MapExportOptions& options,
                  const std::function<void(std::size_t)>& on_keyframe = {});

/** 2D occupancy grid for ROS navigation stacks: `x.png` and, beside it, `x.yaml` (map_server). */
void writeOccupancyGrid(const StaticMap& map,
                        const std::string& path,
                        const MapExportOptions& options);

/** What an output file's name asks for. */
enum class MapFormat
{
  pcd,
  ply,
  octree,
  simplemap,
  scene,  //!< `.3Dscene`: see SceneExport of dyslam::io
  grid
};
/** \throws UserError for another ending than pcd, ply, bt, ot, simplemap, 3Dscene, png. */
[[nodiscard]] MapFormat mapFormatOf(const std::string& path);
}  // namespace dyslam
