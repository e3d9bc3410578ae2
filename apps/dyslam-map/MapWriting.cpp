// SPDX-License-Identifier: BSD-3-Clause
#include "MapWriting.h"

#include <dyslam/core/PendingFile.h>
#include <dyslam/eval/MapPicture.h>
#include <dyslam/mapping/FullResolution.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "../common/Progress.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

bool isWhole(const MapRegion& region)
{
  return region.low.array().isInf().all() && region.high.array().isInf().all();
}

/** Calls `use` with the points that a cloud of this region gets, part by part. */
void forCloudParts(const StaticMap& map,
                   const std::vector<std::size_t>& scans,
                   const MapRegion& region,
                   MapBuilder& builder,
                   const Arguments& a,
                   const std::function<void(const MapPoints&, std::size_t scans_done)>& use)
{
  if (!a.exports.full_resolution && !a.exports.normals)
  {
    map.forEachPart([&](const MapPoints& part) { use(pointsWithin(part, region), scans.size()); });
    return;
  }
  MapPoints points = map.points();
  if (a.exports.normals)
  {
    estimateMapNormals(points, map, a.exports.normal_radius, builder.pool());
  }
  if (!a.exports.full_resolution)
  {
    if (isWhole(region))
    {
      use(points, scans.size());
    }
    else
    {
      use(pointsWithin(points, region), scans.size());
    }
    return;
  }
  const FullResolution full(map, a.builder.map, points);
  for (std::size_t i = 0; i < scans.size(); ++i)
  {
    use(full.of(builder.scans()->read(scans[i]), region), i + 1);
  }
}

std::vector<std::string> cloudsOf(const Arguments& a)
{
  std::vector<std::string> paths;
  for (const auto& path : a.outputs)
  {
    if (mapFormatOf(path) == MapFormat::cloud)
    {
      paths.push_back(path);
    }
  }
  return paths;
}

/** Clouds that are open at the same time, so that the points are made once. */
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

std::string namesOf(const std::vector<std::string>& paths)
{
  std::string names;
  for (const auto& path : paths)
  {
    names += (names.empty() ? "" : " ") + fs::path(path).filename().string();
  }
  return names;
}

std::size_t writeWholeClouds(MapBuilder& builder,
                             const std::vector<std::string>& paths,
                             const Arguments& a)
{
  Progress progress(namesOf(paths), "keyframes", a.quiet);
  std::vector<std::size_t> scans(builder.keyframes());
  for (std::size_t k = 0; k < scans.size(); ++k)
  {
    scans[k] = k;
  }
  CloudFiles files(paths, builder.origin(), a.exports.normals);
  forCloudParts(builder.map(), scans, {}, builder, a,
                [&](const MapPoints& points, std::size_t done)
                {
                  files.add(points);
                  progress.update(static_cast<double>(done) / static_cast<double>(scans.size()),
                                  done);
                });
  files.close();
  progress.finish(scans.size());
  return files.count();
}

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
  TileIndex(const MapBuilder& builder, double size) : origin_(builder.origin())
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

std::size_t writeTiles(MapBuilder& builder,
                       const std::vector<std::string>& paths,
                       const Arguments& a)
{
  const auto tiles = tilesOf(*builder.scans(), a.builder.map, a.exports.tile_size);
  Progress progress(namesOf(paths), "tiles", a.quiet);
  std::vector<TileIndex> indices(paths.size(), TileIndex(builder, a.exports.tile_size));
  std::size_t count = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t)
  {
    const TileMap part(*builder.scans(), a.builder.map, tiles[t]);
    std::unique_ptr<CloudFiles> files;
    forCloudParts(part.map, part.scans, tiles[t].region, builder, a,
                  [&](const MapPoints& points, std::size_t)
                  {
                    if (points.size() == 0)
                    {
                      return;
                    }
                    if (!files)
                    {
                      std::vector<std::string> names;
                      for (std::size_t i = 0; i < paths.size(); ++i)
                      {
                        names.push_back(tilePath(paths[i], tiles[t]));
                        indices[i].add(names.back(), tiles[t]);
                      }
                      files =
                          std::make_unique<CloudFiles>(names, builder.origin(), a.exports.normals);
                    }
                    files->add(points);
                  });
    if (files)
    {
      files->close();
      count += files->count();
    }
    progress.update(static_cast<double>(t + 1) / static_cast<double>(tiles.size()), t + 1);
  }
  for (std::size_t i = 0; i < paths.size(); ++i)
  {
    indices[i].write(paths[i]);
  }
  progress.finish(tiles.size());
  return count;
}

/** With --full, a point per 0.1 m: the limit for smooth viewing. */
SceneContent sceneOf(MapBuilder& builder, const Arguments& a)
{
  SceneContent scene = builder.scene();
  if (builder.scans() == nullptr || !a.exports.full_resolution)
  {
    return scene;
  }
  constexpr double spacing = 0.1;
  const MapPoints points = builder.map().points();
  const FullResolution full(builder.map(), a.builder.map, points);
  VoxelHash taken;
  scene.points.clear();
  scene.intensity.clear();
  for (std::size_t k = 0; k < builder.scans()->size(); ++k)
  {
    const MapPoints part = full.of(builder.scans()->read(k));
    for (std::size_t i = 0; i < part.size(); ++i)
    {
      const auto next = static_cast<std::uint32_t>(scene.points.size());
      const auto cell = voxelCell(part.points[i], static_cast<float>(1 / spacing));
      if (taken.findOrInsert(voxelKey(cell), next) == next)
      {
        scene.points.push_back(part.points[i]);
        scene.intensity.push_back(part.intensity[i]);
      }
    }
  }
  return scene;
}

void writeOther(MapBuilder& builder, const std::string& path, const Arguments& a)
{
  const std::size_t keyframes = builder.keyframes();
  Progress progress(fs::path(path).filename().string(), "keyframes", a.quiet);
  const MapProgress update = [&](std::size_t done)
  { progress.update(static_cast<double>(done) / static_cast<double>(keyframes), done); };
  switch (mapFormatOf(path))
  {
    case MapFormat::cloud:
      break;
    case MapFormat::octree:
      writeOctomap(builder.map(), path, a.exports, update);
      break;
    case MapFormat::simplemap:
      writeSimplemap(builder.map(), path, builder.origin(), update);
      break;
    case MapFormat::scene:
      writeScene(sceneOf(builder, a), path);
      break;
    case MapFormat::grid:
      writeOccupancyGrid(builder.map(), path, a.exports, builder.origin(), update);
      break;
  }
  progress.finish(keyframes);
}

void writePng(const std::vector<std::uint8_t>& png, const std::string& path)
{
  writeWhole(path, std::string_view(reinterpret_cast<const char*>(png.data()), png.size()));
}

/** Points of the uncleaned map that are in no voxel of the clean one. */
std::vector<Eigen::Vector3f> removedPoints(const MapPoints& all, const StaticMap& clean)
{
  std::vector<bool> kept(clean.voxelCount(), false);
  for (const std::uint32_t voxel : clean.points().voxel)
  {
    kept[voxel] = true;
  }
  std::vector<Eigen::Vector3f> removed;
  for (const auto& p : all.points)
  {
    const std::uint32_t voxel = clean.voxelAt(p.cast<double>());
    if (voxel == VoxelHash::none || !kept[voxel])
    {
      removed.push_back(p);
    }
  }
  return removed;
}

void writePictures(const MapBuilder& builder, const Arguments& a)
{
  MapPictureContent content = builder.picture();
  const MapPoints clean = builder.map().points();
  content.points = &clean.points;
  if (!a.picture.empty())
  {
    writePng(renderMapPicture(content), a.picture);
  }
  if (a.compare.empty() || !a.runs.empty())
  {
    return;
  }
  content.objects.clear();
  const MapPoints all = builder.uncleanedMap().points();
  const std::vector<Eigen::Vector3f> removed = removedPoints(all, builder.map());
  MapPictureContent before = content;
  before.points = &all.points;
  before.marked = &removed;
  writePng(renderMapComparison({"everything that was seen; red: removed", before},
                               {"static map", content}),
           a.compare);
}
}  // namespace

std::size_t writeOutputs(MapBuilder& builder, const Arguments& a)
{
  std::size_t points = needsWholeMap(a) ? builder.map().pointCount() : 0;
  const std::vector<std::string> clouds = cloudsOf(a);
  if (!clouds.empty())
  {
    points = a.exports.tile_size > 0 ? writeTiles(builder, clouds, a)
                                     : writeWholeClouds(builder, clouds, a);
  }
  for (const auto& path : a.outputs)
  {
    if (mapFormatOf(path) != MapFormat::cloud)
    {
      writeOther(builder, path, a);
    }
  }
  if (!a.picture.empty() || !a.compare.empty())
  {
    writePictures(builder, a);
  }
  return points;
}
}  // namespace dyslam
