// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/MapTiles.h>
#include <dyslam/mapping/MovingInMap.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

namespace dyslam
{
namespace
{
/** A point as stored in the file. */
struct StoredPoint
{
  float x;
  float y;
  float z;
  float intensity;
  float phase;
};

double distanceTo(const MapRegion& region, const Eigen::Vector2d& p)
{
  return (p - p.cwiseMax(region.low).cwiseMin(region.high)).norm();
}

/** The scan's parts, with `begin` as an index of the cloud. */
std::vector<ScanPart> partsOfCloud(const Frame& frame)
{
  std::vector<ScanPart> parts = frame.scan.parts;
  if (!parts.empty())
  {
    const std::vector<LidarRange> ranges = lidarRanges(frame.scan, frame.cloud);
    for (std::size_t i = 0; i < parts.size(); ++i)
    {
      parts[i].begin = ranges[i + 1].begin;
    }
  }
  return parts;
}

/** Width of the margin of a region [m]: voxels that reach into the region, or into a column of the
 * ground that does, must be complete. */
double marginFor(const StaticMapOptions& options)
{
  constexpr double ground_column = 1;  // [m]
  return std::max(TileMap::margin, ground_column + options.voxel_size);
}

MapRegion widened(const MapRegion& region, double margin)
{
  return {region.low.array() - margin, region.high.array() + margin};
}
}  // namespace

ScanStore::ScanStore(const std::string& path, const StaticMapOptions& options)
    : options_(options), path_(path + ".tmp")
{
  errno = 0;
  file_.open(path_, std::ios::in | std::ios::out | std::ios::binary | std::ios::trunc);
  requireGood();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void ScanStore::requireGood() const
{
  if (!file_)
  {
    throw UserError(path_ + ": the scans cannot be kept on disk: " +
                    (errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
}

void ScanStore::add(const Frame& frame)
{
  const std::size_t count = frame.cloud.size();
  const bool has_intensity = frame.cloud.intensity.size() == count;
  const bool has_phase = frame.cloud.phase.size() == count;
  std::vector<StoredPoint> points(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Eigen::Vector3f& p = frame.cloud.points[i];
    points[i] = {p.x(), p.y(), p.z(), has_intensity ? frame.cloud.intensity[i] : 0.0F,
                 has_phase ? frame.cloud.phase[i] : 0.0F};
  }
  const std::vector<bool> moving = movingInMap(frame, options_);
  const std::string flags(moving.begin(), moving.end());
  entries_.push_back({frame.index, frame.scan.stamp, frame.T_map_vehicle(),
                      frame.scan.T_vehicle_lidar, partsOfCloud(frame), frame.cloud.T_sweep,
                      has_phase, bytes_, count, run_});
  const std::size_t size = count * sizeof(StoredPoint);
  file_.seekp(static_cast<std::streamoff>(bytes_));
  file_.write(reinterpret_cast<const char*>(points.data()), static_cast<std::streamsize>(size));
  file_.write(flags.data(), static_cast<std::streamsize>(count));
  requireGood();
  bytes_ += size + count;
}

Frame ScanStore::read(std::size_t scan)
{
  const Entry& entry = entries_[scan];
  std::vector<StoredPoint> points(entry.points);
  std::string flags(entry.points, '\0');
  file_.seekg(static_cast<std::streamoff>(entry.offset));
  file_.read(reinterpret_cast<char*>(points.data()),
             static_cast<std::streamsize>(entry.points * sizeof(StoredPoint)));
  file_.read(flags.data(), static_cast<std::streamsize>(entry.points));
  requireGood();
  Frame frame;
  frame.index = entry.index;
  frame.scan.stamp = entry.stamp;
  frame.scan.T_vehicle_lidar = entry.T_vehicle_lidar;
  frame.T_odom_vehicle = entry.T_map_vehicle;
  frame.is_keyframe = true;
  frame.cloud.points.reserve(entry.points);
  frame.cloud.intensity.reserve(entry.points);
  frame.cloud.T_sweep = entry.T_sweep;
  for (const StoredPoint& p : points)
  {
    frame.cloud.points.emplace_back(p.x, p.y, p.z);
    frame.cloud.intensity.push_back(p.intensity);
    if (entry.has_phase)
    {
      frame.cloud.phase.push_back(p.phase);
    }
  }
  if (!entry.parts.empty())
  {
    frame.scan.parts = entry.parts;
    frame.cloud.source.resize(entry.points);
    std::iota(frame.cloud.source.begin(), frame.cloud.source.end(), 0U);
  }
  frame.moving.assign(flags.begin(), flags.end());
  return frame;
}

std::vector<MapTile> tilesOf(const ScanStore& scans, const StaticMapOptions& options, double size)
{
  std::set<std::pair<std::int64_t, std::int64_t>> tiles;
  const auto cellOf = [size](double v) { return std::int64_t{cellNumber(v / size)}; };
  const auto regionOf = [size](std::int64_t x, std::int64_t y)
  {
    const Eigen::Vector2d corner(static_cast<double>(x) * size, static_cast<double>(y) * size);
    const auto end = [size](std::int64_t i) { return static_cast<double>(i + 1) * size; };
    return MapRegion{corner, {end(x), end(y)}};
  };
  const double reach = options.max_range;
  for (std::size_t k = 0; k < scans.size(); ++k)
  {
    if (!scans.pose(k).matrix().allFinite())
    {
      continue;
    }
    const Eigen::Vector2d at = scans.pose(k).translation().head<2>();
    for (std::int64_t x = cellOf(at.x() - reach); x <= cellOf(at.x() + reach); ++x)
    {
      for (std::int64_t y = cellOf(at.y() - reach); y <= cellOf(at.y() + reach); ++y)
      {
        if (distanceTo(regionOf(x, y), at) <= reach)
        {
          tiles.emplace(x, y);
        }
      }
    }
  }
  std::vector<MapTile> result;
  for (const auto& [x, y] : tiles)
  {
    result.push_back({x, y, regionOf(x, y)});
  }
  return result;
}

std::vector<TileBlock> blocksOf(const std::vector<MapTile>& tiles, double size)
{
  constexpr double largest_side = 100;  // about the reach of a scan [m]
  constexpr double most_tiles = 8;      // along a side: the files of all tiles are open together
  const double along = std::clamp(std::floor(largest_side / size), 1.0, most_tiles);
  const auto blockOf = [along](std::int64_t i)
  { return static_cast<std::int64_t>(std::floor(static_cast<double>(i) / along)); };
  std::map<std::pair<std::int64_t, std::int64_t>, TileBlock> blocks;
  for (const MapTile& tile : tiles)
  {
    TileBlock& block = blocks[{blockOf(tile.x), blockOf(tile.y)}];
    const MapRegion before = block.tiles.empty() ? tile.region : block.region;
    block.region = {before.low.cwiseMin(tile.region.low), before.high.cwiseMax(tile.region.high)};
    block.tiles.push_back(tile);
  }
  std::vector<TileBlock> result;
  for (auto& [place, block] : blocks)
  {
    result.push_back(std::move(block));
  }
  return result;
}

TileMap::TileMap(ScanStore& store, const StaticMapOptions& options, const MapRegion& region)
    : map(options, keyframes, widened(region, marginFor(options)))
{
  // Largest distance of a scan from the region; the margin's corners are less than two margins
  // away.
  const double reach =
      std::max(options.max_range, options.visibility_range) + 2 * marginFor(options);
  for (std::size_t k = 0; k < store.size(); ++k)
  {
    const Pose& T = store.pose(k);
    if (T.matrix().allFinite() && distanceTo(region, T.translation().head<2>()) <= reach)
    {
      const Frame frame = store.read(k);
      if (!scans.empty() && store.run(k) != store.run(scans.back()))
      {
        map.beginRun();
      }
      scans.push_back(k);
      keyframes.add(keyframeOf(frame));
      map.insert(frame);
    }
  }
}

MapPoints pointsWithin(const MapPoints& points, const MapRegion& region)
{
  MapPoints result;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (region.contains(points.points[i].cast<double>()))
    {
      result.add(points, i);
    }
  }
  return result;
}
}  // namespace dyslam
