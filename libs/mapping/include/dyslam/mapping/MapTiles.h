// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
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
  /** \param path the scans are stored in `<path>.tmp`, which loses its name at once: nothing is
   * left of it when the program ends or is killed. \throws UserError if it cannot be written. */
  ScanStore(const std::string& path, const StaticMapOptions& options);

  /** Adds a scan at its final pose; points in the boxes of moving objects are stored as moving.
   * \throws UserError if the file cannot be written. */
  void add(const Frame& frame);
  /** The scans added from here on belong to another run, see StaticMap::beginRun(). */
  void beginRun() { ++run_; }
  [[nodiscard]] std::size_t run(std::size_t scan) const { return entries_[scan].run; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /** Reads a scan: index, stamp, pose, sensor, points, intensities, phases and moving labels. The
   * parts of a scan of several lidars begin at points of the cloud, and `source` counts these.
   * \throws UserError if the file cannot be read. */
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
    std::vector<ScanPart> parts;  //!< parts that begin at points of the cloud
    Pose T_sweep = Pose::Identity();
    bool has_phase = false;
    std::uint64_t offset = 0;
    std::size_t points = 0;
    std::size_t run = 0;
  };

  void requireGood() const;

  StaticMapOptions options_;
  std::string path_;  //!< of the file of the scans, while it had a name
  std::fstream file_;
  std::vector<Entry> entries_;
  std::uint64_t bytes_ = 0;
  std::size_t run_ = 0;
};

/** A square of the map plane. */
struct MapTile
{
  std::int64_t x = 0;  //!< the lower corner of the tile is (x, y) times its side
  std::int64_t y = 0;
  MapRegion region;
};

/** Tiles that the scans can reach, by x and then y. \param size side of a tile [m] */
[[nodiscard]] std::vector<MapTile> tilesOf(const ScanStore& scans,
                                           const StaticMapOptions& options,
                                           double size);

/** Tiles that are built together, so that each scan is read and thinned once for all of them. */
struct TileBlock
{
  MapRegion region;  //!< around the tiles
  std::vector<MapTile> tiles;
};

/** Every tile in a block of at most 100 m and 8 tiles along each side, or of one larger tile.
 * \param size side of a tile [m] */
[[nodiscard]] std::vector<TileBlock> blocksOf(const std::vector<MapTile>& tiles, double size);

/** The static map of a region and a margin around it, made of the scans that can reach it. It
 * equals that part of the whole map, since each of its voxels is hit by the same scans. */
struct TileMap
{
  /** Least width of the margin, so that normals and ground are correct up to the border [m]; with
   * large voxels it is wider. */
  static constexpr double margin = 2;

  TileMap(ScanStore& scans, const StaticMapOptions& options, const MapRegion& region);
  TileMap(const TileMap&) = delete;  // `map` refers to `keyframes`
  TileMap& operator=(const TileMap&) = delete;

  std::vector<std::size_t> scans;  //!< scans that can reach the region
  KeyframeStore keyframes;
  StaticMap map;
};

/** The points within a region. */
[[nodiscard]] MapPoints pointsWithin(const MapPoints& points, const MapRegion& region);
}  // namespace dyslam
