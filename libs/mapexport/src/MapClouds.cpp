// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/mapexport/MapCloudFile.h>
#include <dyslam/mapexport/MapClouds.h>
#include <dyslam/mapexport/MapFormat.h>
#include <dyslam/mapping/FullResolution.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "YamlText.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

MapRegion overlapOf(const MapRegion& a, const MapRegion& b)
{
  return {a.low.cwiseMax(b.low), a.high.cwiseMin(b.high)};
}

bool isEmpty(const MapRegion& region)
{
  return (region.low.array() >= region.high.array()).any();
}

/** Clouds that are open at the same time. One that cannot be written does not keep the others from
 * being completed. All functions throw UserError once none is left. */
class CloudFiles
{
 public:
  CloudFiles(const std::vector<std::string>& paths, const CloudDescription& description)
  {
    for (const auto& path : paths)
    {
      attempt([&] { files_.push_back(std::make_unique<MapCloudFile>(path, description)); });
    }
    requireAny();
  }
  void add(const MapPoints& points)
  {
    forEachFile([&](MapCloudFile& file) { file.add(points); });
    count_ += points.size();
  }
  /** \throws UserError if one of the files could not be written. */
  void close()
  {
    forEachFile([](MapCloudFile& file) { file.close(); });
    if (!failures_.empty())
    {
      throw UserError(failures_);
    }
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  template <typename Work>
  bool attempt(const Work& work)
  {
    try
    {
      work();
      return true;
    }
    catch (const UserError& error)
    {
      appendWord(failures_, error.what(), "; ");
      return false;
    }
  }
  /** Drops the files with which `use` fails. */
  template <typename Use>
  void forEachFile(const Use& use)
  {
    std::vector<std::unique_ptr<MapCloudFile>> good;
    for (auto& file : files_)
    {
      if (attempt([&] { use(*file); }))
      {
        good.push_back(std::move(file));
      }
    }
    files_ = std::move(good);
    requireAny();
  }
  void requireAny() const
  {
    if (files_.empty() && !failures_.empty())
    {
      throw UserError(failures_);
    }
  }

  std::vector<std::unique_ptr<MapCloudFile>> files_;
  std::string failures_;
  std::size_t count_ = 0;
};

/** `map.las` becomes `map_3_-2.las`, without the folder. */
std::string tileName(const fs::path& file, std::int64_t x, std::int64_t y)
{
  return file.stem().string() + "_" + std::to_string(x) + "_" + std::to_string(y) +
         file.extension().string();
}

bool isTileName(const fs::path& file, const std::string& name)
{
  const char* end = name.data() + name.size();
  std::int64_t x = 0;
  std::int64_t y = 0;
  const std::size_t numbers = std::min(file.stem().string().size() + 1, name.size());
  const char* separator = std::from_chars(name.data() + numbers, end, x).ptr;
  std::from_chars(separator == end ? end : separator + 1, end, y);
  return name == tileName(file, x, y);
}

/** `map.las` has the positions of its tiles in `map.las.tiles.yaml`. */
std::string indexPath(const fs::path& file)
{
  return (file.parent_path() / (file.filename().string() + ".tiles.yaml")).string();
}

/** Names of the tiles in the index of an earlier export; none without an index. */
std::vector<std::string> tilesBefore(const fs::path& file)
{
  std::ifstream index(indexPath(file));
  std::vector<std::string> names;
  for (std::string line; std::getline(index, line);)
  {
    const std::string name = fromYamlText(line, ": [");
    if (isTileName(file, name))
    {
      names.push_back(name);
    }
  }
  return names;
}

/** \throws UserError if the tile cannot be removed. */
void removeTile(const fs::path& tile)
{
  std::error_code error;
  if (fs::is_regular_file(fs::symlink_status(tile, error)))
  {
    fs::remove(tile, error);
    if (error)
    {
      throw UserError(tile.string() +
                      ": is a tile of an earlier map and cannot be removed: " + error.message());
    }
  }
}

/** Positions of the tiles, in the layout that Autoware reads. */
class TileIndex
{
 public:
  /** Reads the index of an earlier export, if there is one. */
  TileIndex(const std::string& path, const Eigen::Vector3d& origin, double size)
      : file_(path), origin_(origin), before_(tilesBefore(path))
  {
    head_ = formatted("x_resolution: %.10g\ny_resolution: %.10g\n", size, size);
  }
  /** \return path of the tile's cloud */
  std::string add(const MapTile& tile)
  {
    const std::string name = tileName(file_, tile.x, tile.y);
    const std::string text = formatted(": [%.10g, %.10g]\n", tile.region.low.x() + origin_.x(),
                                       tile.region.low.y() + origin_.y());
    lines_[{tile.x, tile.y}] = yamlText(name) + text;
    names_.insert(name);
    return (file_.parent_path() / name).string();
  }
  /** Writes the index and removes the tiles of the earlier export that are not in it. */
  void write() const
  {
    std::string text = head_;
    for (const auto& [tile, line] : lines_)
    {
      text += line;
    }
    writeWhole(indexPath(file_), text);
    for (const std::string& name : before_)
    {
      if (names_.count(name) == 0)
      {
        removeTile(file_.parent_path() / name);
      }
    }
  }

 private:
  fs::path file_;
  Eigen::Vector3d origin_;
  std::string head_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> lines_;  // by tile
  std::set<std::string> names_;
  std::vector<std::string> before_;
};

/** The clouds of one tile; without a point there are none. */
class TileFiles
{
 public:
  /** \param area of which the points are */
  TileFiles(const MapTile& tile, const MapRegion& area)
      : tile_(tile), region_(overlapOf(tile.region, area))
  {
  }

  /** Adds those of the points that are in the tile. */
  void add(const MapPoints& of_block,
           const CloudDescription& description,
           std::vector<TileIndex>& indices)
  {
    const MapPoints points = pointsWithin(of_block, region_);
    if (points.size() == 0)
    {
      return;
    }
    if (!files_)
    {
      std::vector<std::string> names;
      for (TileIndex& index : indices)
      {
        names.push_back(index.add(tile_));
      }
      files_ = std::make_unique<CloudFiles>(names, description);
    }
    files_->add(points);
  }
  [[nodiscard]] bool empty() const { return !files_; }
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
  MapRegion region_;
  std::unique_ptr<CloudFiles> files_;
};
}  // namespace

MapClouds::MapClouds(const StaticMapOptions& map,
                     const MapExportOptions& exports,
                     const Eigen::Vector3d& origin,
                     ThreadPool& pool,
                     std::optional<double> recorded)
    : map_options_(map),
      exports_(exports),
      description_{exports.normals, origin, recorded, exports.epsg},
      area_(areaOf(exports, origin)),
      pool_(pool)
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
    if (region.isWhole())
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
  CloudFiles files(paths, description_);
  forEachPart(map, all, area_, scans,
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

std::size_t MapClouds::writeTiles(ScanStore& scans,
                                  const std::vector<std::string>& paths,
                                  const TileProgress& on_tile) const
{
  const auto tiles = tilesOf(scans, map_options_, exports_.tile_size);
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  std::vector<TileIndex> indices;
  for (const std::string& path : paths)
  {
    const Eigen::Vector3d origin = mapFormatOf(path).holds_origin ? description_.origin : zero;
    indices.emplace_back(path, origin, exports_.tile_size);
  }
  std::size_t count = 0;
  std::size_t done = 0;
  std::size_t written = 0;
  for (const TileBlock& block : blocksOf(tiles, exports_.tile_size))
  {
    if (isEmpty(overlapOf(block.region, area_)))
    {
      done += block.tiles.size();
      continue;
    }
    const TileMap part(scans, map_options_, block.region);
    std::vector<TileFiles> files;
    for (const MapTile& tile : block.tiles)
    {
      files.emplace_back(tile, area_);
    }
    forEachPart(part.map, part.scans, block.region, &scans,
                [&](const MapPoints& points, std::size_t)
                {
                  for (TileFiles& tile : files)
                  {
                    tile.add(points, description_, indices);
                  }
                });
    for (TileFiles& tile : files)
    {
      count += tile.close();
      written += tile.empty() ? 0 : 1;
      ++done;
      if (on_tile)
      {
        on_tile(done, tiles.size(), written);
      }
    }
  }
  for (const TileIndex& index : indices)
  {
    index.write();
  }
  return count;
}
}  // namespace dyslam
