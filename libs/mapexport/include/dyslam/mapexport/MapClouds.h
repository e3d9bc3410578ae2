// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/mapexport/MapCloudFile.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/mapping/MapTiles.h>
#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Called after each tile that scans can reach, with the number of tiles done, of all tiles, and of
 * files written (for tiles with points). */
using TileProgress = std::function<void(std::size_t done, std::size_t all, std::size_t written)>;

/** Writes a static map as clouds (MapCloudFile), whole or in tiles: one point per voxel or, with
 * `full_resolution`, every static point; with normals, if `normals` is on; of the `area` alone, if
 * there is one.
 *
 * Several files are written together, so that the points are computed once. */
class MapClouds
{
 public:
  /** \param map of the map and its tiles \param origin of the map frame in the coordinates of the
   * files [m] \param pool outlives this \param recorded CloudDescription::recorded */
  MapClouds(const StaticMapOptions& map,
            const MapExportOptions& exports,
            const Eigen::Vector3d& origin,
            ThreadPool& pool,
            std::optional<double> recorded = std::nullopt);

  /** \param scans that the map was made of, one per keyframe; read for `full_resolution` only, else
   * it may be null \param on_keyframe called with the number of keyframes that are done
   * \return number of points \throws UserError for files that cannot be written, after the others
   *   are complete; std::invalid_argument for `full_resolution` without scans. */
  std::size_t write(const StaticMap& map,
                    ScanStore* scans,
                    const std::vector<std::string>& paths,
                    const MapProgress& on_keyframe = {}) const;

  /** Writes the map of the scans in tiles, with one TileBlock in memory at a time: `map.las`
   * becomes `map_X_Y.las` for each tile with points, and `map.las.tiles.yaml` with their lower
   * corners, in the coordinates of the points and the layout that Autoware reads. Tiles of an
   * earlier index of this name that the new index does not list are removed. \return number of
   * points \throws UserError for a file that cannot be written. */
  std::size_t writeTiles(ScanStore& scans,
                         const std::vector<std::string>& paths,
                         const TileProgress& on_tile = {}) const;

 private:
  using UsePart = std::function<void(const MapPoints& points, std::size_t scans_done)>;

  void forEachPart(const StaticMap& map,
                   const std::vector<std::size_t>& used,
                   const MapRegion& region,
                   ScanStore* scans,
                   const UsePart& use) const;

  StaticMapOptions map_options_;
  MapExportOptions exports_;
  CloudDescription description_;
  MapRegion area_;  //!< areaOf() the options
  ThreadPool& pool_;
};
}  // namespace dyslam
