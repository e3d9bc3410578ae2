// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace dyslam
{
/** Scans on disk, with their poses and what moves in them: 21 bytes a point in a temporary file.
 * From these a map is built tile by tile, or in full resolution, without all scans in memory. */
class ScanStore
{
 public:
  /** \param path the file is `<path>.tmp`; it is removed with this object. \throws UserError. */
  ScanStore(const std::string& path, const StaticMapOptions& options);

  /** A scan at its final pose; moving objects' boxes count as moving points. \throws UserError. */
  void add(const Frame& frame);
  /** The scans from here on are of another run: StaticMap::beginRun(). */
  void beginRun() { ++run_; }
  [[nodiscard]] std::size_t run(std::size_t scan) const { return entries_[scan].run; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /** Index, stamp, pose, sensor, points, intensities, phases and what moves. The parts of a scan of
   * several lidars begin at points of the cloud, and `source` counts these. \throws UserError. */
  [[nodiscard]] Frame read(std::size_t scan);
  [[nodiscard]] const Pose& pose(std::size_t scan) const { return entries_[scan].T_map_vehicle; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  struct Entry
  {
    std::size_t index = 0;
    double stamp = 0;
    Pose T_map_vehicle = Pose::Identity();
    Pose T_vehicle_lidar = Pose::Identity();
    std::vector<ScanPart> parts;  //!< by points of the cloud
    Pose T_sweep = Pose::Identity();
    bool has_phase = false;
    std::uint64_t offset = 0;
    std::size_t points = 0;
    std::size_t run = 0;
  };

  void requireGood() const;

  StaticMapOptions options_;
  PendingFile pending_;  //!< never committed
  std::fstream file_;
  std::vector<Entry> entries_;
  std::uint64_t bytes_ = 0;
  std::size_t run_ = 0;
};

/** A square of the map plane. */
struct MapTile
{
  std::int64_t x = 0;  //!< its lower corner is (x, y) times the side
  std::int64_t y = 0;
  MapRegion region;
};

/** Tiles that the scans can reach, by x and then y. \param size side of a tile [m] */
[[nodiscard]] std::vector<MapTile> tilesOf(const ScanStore& scans,
                                           const StaticMapOptions& options,
                                           double size);

/** The static map of one tile, from those scans that can reach it. It equals that part of the whole
 * map: each of its voxels is hit by the same scans. A margin around the tile is in it as well. */
struct TileMap
{
  /** Width of the margin, so that normals and ground are correct up to the border [m]. */
  static constexpr double margin = 2;

  TileMap(ScanStore& scans, const StaticMapOptions& options, const MapTile& tile);
  TileMap(const TileMap&) = delete;  // `map` refers to `keyframes`
  TileMap& operator=(const TileMap&) = delete;

  std::vector<std::size_t> scans;  //!< that can reach it
  KeyframeStore keyframes;
  StaticMap map;
};

/** The points within a region. */
[[nodiscard]] MapPoints pointsWithin(const MapPoints& points, const MapRegion& region);
}  // namespace dyslam
