// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace dyslam
{
struct MapExportOptions : Options
{
  bool full_resolution = false;      //!< clouds with every static point, not one per voxel
  bool normals = true;               //!< clouds with normals
  double normal_radius = 0.8;        //!< radius of the neighbourhood of a normal [m]
  double tile_size = 0;              //!< clouds in tiles of this side, at least 5 [m]; 0: one file
  double octree_resolution = 0.2;    //!< side of octomap's leaves [m]
  double octree_range = 40.0;        //!< rays are cut off here [m]
  double grid_resolution = 0.1;      //!< side of the occupancy grid's cells [m]
  double obstacle_min_height = 0.3;  //!< above ground: lower objects can be driven over [m]
  double obstacle_max_height = 2.2;  //!< above ground: higher objects can be driven under [m]
  int obstacle_min_hits = 2;  //!< least keyframes that observed an obstacle, if the map has so many
  int grid_max_cells = 100000000;  //!< a larger grid gets coarser cells

  void describe(OptionsVisitor& visitor) override;
};

/** Called with the number of keyframes done after each of them; may be empty. */
using MapProgress = std::function<void(std::size_t)>;

/** Every writer throws UserError where the file cannot be written; the file is renamed to its final
 * name when it is complete. The same map gives the same bytes. An empty map gives a valid file
 * without points. `origin` is the origin of the map frame in the coordinates of the file [m], for
 * maps far from zero.
 */

/** A cloud that is written part by part: `.pcd`, `.ply` (both binary; x y z intensity and normals)
 * or `.las` (1.2, format 0, millimetres; normals as extra bytes).
 *
 * With an origin other than 0, `.las` and `.ply` (then in float64) hold the coordinates in full;
 * `.pcd`, whose readers expect float32, stays relative to the origin and names it as its viewpoint.
 */
class MapCloudFile
{
 public:
  MapCloudFile(const std::string& path,
               bool normals,
               const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());
  ~MapCloudFile();
  MapCloudFile(const MapCloudFile&) = delete;
  MapCloudFile& operator=(const MapCloudFile&) = delete;

  /** \throws std::invalid_argument if the file has normals and the points have none. */
  void add(const MapPoints& points);
  [[nodiscard]] std::size_t count() const;
  /** Call it last: without it there is no file. \throws UserError. */
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/** A MapCloudFile of these points, with normals if they have some. */
void writeMapCloud(const MapPoints& points,
                   const std::string& path,
                   const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/** The points of the map; if it has more than `most`, one of each cube, whose side is chosen
 * accordingly. */
[[nodiscard]] MapPoints thinnedPoints(const StaticMap& map, std::size_t most);

/** MRPT's CSimpleMap: per keyframe its pose and the static points as CObservationPointCloud. */
void writeSimplemap(const StaticMap& map,
                    const std::string& path,
                    const Eigen::Vector3d& origin = Eigen::Vector3d::Zero(),
                    const MapProgress& on_keyframe = {});

/** octomap's `.bt` (binary) or `.ot` (full): keyframes' static points and the rays to them. Stays
 * relative to the origin. \throws UserError for a map beyond the reach of octomap's keys. */
void writeOctomap(const StaticMap& map,
                  const std::string& path,
                  const MapExportOptions& options,
                  const MapProgress& on_keyframe = {});

/** 2D occupancy grid for navigation: `x.png` and, beside it, `x.yaml` (ROS's map_server), or
 * `x.gridmap` (MRPT's COccupancyGridMap2D). */
void writeOccupancyGrid(const StaticMap& map,
                        const std::string& path,
                        const MapExportOptions& options,
                        const Eigen::Vector3d& origin = Eigen::Vector3d::Zero(),
                        const MapProgress& on_keyframe = {});

/** Kind of an output file, by the ending of its name. */
enum class MapFormat
{
  cloud,
  octree,
  simplemap,
  scene,  //!< `.3Dscene`: see SceneExport of dyslam::io
  grid
};
/** \throws UserError for another ending than pcd, ply, las, bt, ot, simplemap, 3Dscene, png,
 * gridmap. */
[[nodiscard]] MapFormat mapFormatOf(const std::string& path);
}  // namespace dyslam
