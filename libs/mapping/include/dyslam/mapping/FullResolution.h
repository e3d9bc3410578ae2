// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/mapping/MapTiles.h>
#include <dyslam/mapping/StaticMap.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** Fills in `points.normals`: the normal of the plane fitted to the map points within `radius` [m]
 * of each point (at most the 20 nearest), oriented towards the lidar that saw the point in its
 * keyframe. */
void estimateMapNormals(MapPoints& points, const StaticMap& map, double radius, ThreadPool& pool);

/** Selects the static points of scans: those in voxels of the cleaned map, or in an unobserved
 * voxel adjacent to one. */
class FullResolution
{
 public:
  /** \param map outlives this object \param points map.points(), outlives this object; if it has
   * normals, every point of a scan gets the normal of its voxel, oriented towards the lidar that
   * measured the point */
  FullResolution(const StaticMap& map, const StaticMapOptions& options, const MapPoints& points);

  /** Every static point of a scan within the ranges of the options and in the region, unthinned,
   * in the order of its cloud; map frame. */
  [[nodiscard]] MapPoints of(const Frame& frame, const MapRegion& region = {}) const;

 private:
  /** The map point that represents `p`; VoxelHash::none if that is not in the map. */
  [[nodiscard]] std::uint32_t pointAt(const Eigen::Vector3d& p) const;

  const StaticMap& map_;
  StaticMapOptions options_;
  const MapPoints& points_;
  std::vector<std::uint32_t> point_of_voxel_;
};

/** The static points of all scans, the first of each cube, without normals.
 * \param map made of the scans \param spacing side of the cubes [m] */
[[nodiscard]] MapPoints thinnedFullResolution(const StaticMap& map,
                                              const StaticMapOptions& options,
                                              ScanStore& scans,
                                              double spacing);
}  // namespace dyslam
