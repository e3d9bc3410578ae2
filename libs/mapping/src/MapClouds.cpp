// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PendingFile.h>
#include <dyslam/mapping/FullResolution.h>
#include <dyslam/mapping/MapClouds.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <stdexcept>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

bool isWhole(const MapRegion& region)
{
  return region.low.array().isInf().all() && region.high.array().isInf().all();
}

/** Clouds that are open at the same time. */
class CloudFiles
{
 public:
  CloudFiles(const std::vector<std::string>& paths, const Eigen::Vector3d& origin, bool normals)
  {
    for (const auto& path : paths)
    {
      files_.push_back(std::make_unique<MapCloudFile>(path, normals, origin));
    }
  }
  void add(const MapPoints& points)
  {
    for (auto& file : files_)
    {
      file->add(points);
    }
    count_ += points.size();
  }
  void close()
  {
    for (auto& file : files_)
    {
      file->close();
    }
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::vector<std::unique_ptr<MapCloudFile>> files_;
  std::size_t count_ = 0;
};

/** `map.las` becomes `map_3_-2.las`. */
std::string tilePath(const std::string& path, const MapTile& tile)
{
  const fs::path file(path);
  const std::string number = "_" + std::to_string(tile.x) + "_" + std::to_string(tile.y);
  return (file.parent_path() / (file.stem().string() + number + file.extension().string()))
      .string();
}

/** Positions of the tiles, in the layout that Autoware reads. */
class TileIndex
{
 public:
  TileIndex(const Eigen::Vector3d& origin, double size) : origin_(origin)
  {
    char text[128];
    std::snprintf(text, sizeof text, "x_resolution: %.10g\ny_resolution: %.10g\n", size, size);
    text_ = text;
  }
  void add(const std::string& path, const MapTile& tile)
  {
    char text[128];
    std::snprintf(text, sizeof text, ": [%.10g, %.10g]\n", tile.region.low.x() + origin_.x(),
                  tile.region.low.y() + origin_.y());
    text_ += fs::path(path).filename().string() + text;
  }
  void write(const std::string& path) const
  {
    const fs::path file(path);
    writeWhole(
        (file.parent_path() / (file.stem().string() + file.extension().string() + ".tiles.yaml"))
            .string(),
        text_);
  }

 private:
  Eigen::Vector3d origin_;
  std::string text_;
};

/** The clouds of one tile; without a point there are none. */
class TileFiles
{
 public:
  TileFiles(const MapTile& tile, const std::vector<std::string>& paths) : tile_(tile), paths_(paths)
  {
  }

  void add(const MapPoints& points,
           const Eigen::Vector3d& origin,
           bool normals,
           std::vector<TileIndex>& indices)
  {
    if (points.size() == 0)
    {
      return;
    }
    if (!files_)
    {
      std::vector<std::string> names;
      for (std::size_t i = 0; i < paths_.size(); ++i)
      {
        names.push_back(tilePath(paths_[i], tile_));
        indices[i].add(names.back(), tile_);
      }
      files_ = std::make_unique<CloudFiles>(names, origin, normals);
    }
    files_->add(points);
  }
  /** \return number of points */
  std::size_t close()
  {
    if (!files_)
    {
      return 0;
    }
    files_->close();
    return files_->count();
  }

 private:
  const MapTile& tile_;
  const std::vector<std::string>& paths_;
  std::unique_ptr<CloudFiles> files_;
};
}  // namespace

MapClouds::MapClouds(const StaticMapOptions& map,
                     const MapExportOptions& exports,
                     const Eigen::Vector3d& origin,
                     ThreadPool& pool)
    : map_options_(map), exports_(exports), origin_(origin), pool_(pool)
{
}

/** Calls `use` with the points that a cloud of this region gets, part by part.
 * \param used the scans that can reach the region */
void MapClouds::forEachPart(const StaticMap& map,
                            const std::vector<std::size_t>& used,
                            const MapRegion& region,
                            ScanStore* scans,
                            const UsePart& use) const
{
  if (!exports_.full_resolution && !exports_.normals)
  {
    map.forEachPart([&](const MapPoints& part) { use(pointsWithin(part, region), used.size()); });
    return;
  }
  MapPoints points = map.points();
  if (exports_.normals)
  {
    estimateMapNormals(points, map, exports_.normal_radius, pool_);
  }
  if (!exports_.full_resolution)
  {
    if (isWhole(region))
    {
      use(points, used.size());
    }
    else
    {
      use(pointsWithin(points, region), used.size());
    }
    return;
  }
  const FullResolution full(map, map_options_, points);
  for (std::size_t i = 0; i < used.size(); ++i)
  {
    use(full.of(scans->read(used[i]), region), i + 1);
  }
}

std::size_t MapClouds::write(const StaticMap& map,
                             ScanStore* scans,
                             const std::vector<std::string>& paths,
                             const MapProgress& on_keyframe) const
{
  if (exports_.full_resolution && scans == nullptr)
  {
    throw std::invalid_argument("MapClouds: full_resolution without scans");
  }
  std::vector<std::size_t> all(map.keyframes().size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  CloudFiles files(paths, origin_, exports_.normals);
  forEachPart(map, all, {}, scans,
              [&](const MapPoints& points, std::size_t done)
              {
                files.add(points);
                if (on_keyframe)
                {
                  on_keyframe(done);
                }
              });
  files.close();
  return files.count();
}

std::size_t MapClouds::writeTiles(
    ScanStore& scans,
    const std::vector<std::string>& paths,
    const std::function<void(std::size_t, std::size_t)>& on_tile) const
{
  const auto tiles = tilesOf(scans, map_options_, exports_.tile_size);
  std::vector<TileIndex> indices(paths.size(), TileIndex(origin_, exports_.tile_size));
  std::size_t count = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t)
  {
    const TileMap part(scans, map_options_, tiles[t]);
    TileFiles files(tiles[t], paths);
    forEachPart(part.map, part.scans, tiles[t].region, &scans,
                [&](const MapPoints& points, std::size_t)
                { files.add(points, origin_, exports_.normals, indices); });
    count += files.close();
    if (on_tile)
    {
      on_tile(t + 1, tiles.size());
    }
  }
  for (std::size_t i = 0; i < paths.size(); ++i)
  {
    indices[i].write(paths[i]);
  }
  return count;
}
}  // namespace dyslam
