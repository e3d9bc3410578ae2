// SPDX-License-Identifier: BSD-3-Clause
#include "MapWriting.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapexport/MapClouds.h>
#include <dyslam/mapexport/MapFormat.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "MapPictures.h"
#include "MapScene.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

double fractionOf(std::size_t done, std::size_t all)
{
  return static_cast<double>(done) / static_cast<double>(all);
}

/** Outputs whose coordinates are float32 or small keys. */
std::vector<std::string> relativeOutputs(const MapOutputs& outputs)
{
  std::vector<std::string> relative;
  std::copy_if(outputs.maps.begin(), outputs.maps.end(), std::back_inserter(relative),
               [](const std::string& path) { return !mapFormatOf(path).holds_origin; });
  if (!outputs.labelled_map.empty())
  {
    relative.push_back(outputs.labelled_map);
  }
  return relative;
}

void warnOfOrigin(const Eigen::Vector3d& origin, const MapOutputs& outputs, MapListener& listener)
{
  if (origin.isZero(0))
  {
    return;
  }
  const std::string numbers = formatted("%.0f %.0f %.0f", origin.x(), origin.y(), origin.z());
  for (const std::string& path : relativeOutputs(outputs))
  {
    listener.warn(path +
                  ": coordinates so far from zero would be rounded: the map is relative to " +
                  numbers);
  }
}

/** Of a map whose float32 coordinates are rounded: the trajectory is long, or has a wrong pose. */
void warnOfReach(double reach, MapListener& listener)
{
  constexpr double precise = 100000;  // [m]; float32 rounds to 8 mm there
  if (reach <= precise)
  {
    return;
  }
  const auto farthest = static_cast<float>(reach);
  const float step = std::nextafter(farthest, std::numeric_limits<float>::infinity()) - farthest;
  const std::string text = formatted(
      "the map reaches %.0f km from its origin, where coordinates are rounded to %.2g m; "
      "are all poses of the trajectory right?",
      reach / 1000, static_cast<double>(step));
  listener.warn(text);
}

std::vector<std::string> cloudsOf(const MapOutputs& outputs)
{
  std::vector<std::string> paths;
  for (const auto& path : outputs.maps)
  {
    if (mapFormatOf(path).kind == MapKind::cloud)
    {
      paths.push_back(path);
    }
  }
  return paths;
}

std::string namesOf(const std::vector<std::string>& paths)
{
  std::string names;
  for (const auto& path : paths)
  {
    appendWord(names, fs::path(path).filename().string(), " ");
  }
  return names;
}

/** All clouds together. \return their points */
std::size_t writeClouds(MapBuilder& builder,
                        const std::vector<std::string>& paths,
                        const MapExportOptions& exports,
                        MapListener& listener)
{
  const MapClouds clouds(builder.options().map, exports, builder.origin(), builder.pool(),
                         builder.recorded());
  if (exports.tile_size > 0)
  {
    listener.beginWriting(namesOf(paths), "tiles");
    std::size_t tiles = 0;
    const std::size_t points =
        clouds.writeTiles(*builder.scans(), paths,
                          [&](std::size_t done, std::size_t all, std::size_t written)
                          {
                            tiles = written;
                            listener.update(fractionOf(done, all), written);
                          });
    listener.finish(tiles);
    return points;
  }
  const std::size_t keyframes = builder.keyframes();
  listener.beginWriting(namesOf(paths), "keyframes");
  const std::size_t points =
      clouds.write(builder.map(), builder.scans(), paths,
                   [&](std::size_t done) { listener.update(fractionOf(done, keyframes), done); });
  listener.finish(keyframes);
  return points;
}

/** \return a warning if the cells are larger than the option; else empty */
std::string coarserCells(const std::string& path, double side, const MapExportOptions& exports)
{
  if (side <= exports.grid_resolution)
  {
    return {};
  }
  const std::string text = formatted(
      ": the cells have %g m instead of map_export.grid_resolution=%g, of which there "
      "would be more than map_export.grid_max_cells=%d, or more than a million in a row",
      side, exports.grid_resolution, exports.grid_max_cells);
  return path + text;
}

/** Writes a map that is no cloud. */
void writeOther(MapBuilder& builder,
                const std::string& path,
                const MapExportOptions& exports,
                MapListener& listener)
{
  const std::size_t keyframes = builder.keyframes();
  listener.beginWriting(fs::path(path).filename().string(), "keyframes");
  const MapProgress update = [&](std::size_t done)
  { listener.update(fractionOf(done, keyframes), done); };
  std::string warning;
  switch (mapFormatOf(path).kind)
  {
    case MapKind::cloud:
      break;
    case MapKind::octree:
      writeOctomap(builder.map(), path, exports, builder.origin(), update);
      break;
    case MapKind::simplemap:
      writeSimplemap(builder.map(), path, builder.origin(), areaOf(exports, builder.origin()),
                     update);
      break;
    case MapKind::scene:
      writeScene(sceneOf(builder, exports), path);
      break;
    case MapKind::grid:
      warning = coarserCells(
          path, writeOccupancyGrid(builder.map(), path, exports, builder.origin(), update),
          exports);
      break;
  }
  listener.finish(keyframes);
  if (!warning.empty())
  {
    listener.warn(warning);
  }
}

void writeLabelledMap(const LabelledMap& map, const std::string& path)
{
  writeCloud(path, map.points());
  writeLabels(fs::path(path).replace_extension(".label").string(), map.labels());
}

/** Writers of all outputs. \param report gets the number of points of the clouds */
std::vector<FileWriter> writersOf(const MapOutputs& outputs,
                                  MapBuilder& builder,
                                  MapListener& listener,
                                  MapReport& report)
{
  std::vector<FileWriter> writers;
  if (const auto clouds = cloudsOf(outputs); !clouds.empty())
  {
    writers.push_back({namesOf(clouds), [&outputs, &builder, &listener, &report, clouds] {
                         report.points = writeClouds(builder, clouds, outputs.exports, listener);
                       }});
  }
  for (const std::string& path : outputs.maps)
  {
    if (mapFormatOf(path).kind != MapKind::cloud)
    {
      writers.push_back({path, [&] { writeOther(builder, path, outputs.exports, listener); }});
    }
  }
  if (!outputs.picture.empty())
  {
    writers.push_back({outputs.picture, [&] { writeMapPicture(builder, outputs.picture); }});
  }
  if (!outputs.comparison.empty() && builder.uncleanedMap() != nullptr)
  {
    writers.push_back(
        {outputs.comparison, [&] { writeCleaningPicture(builder, outputs.comparison); }});
  }
  if (const std::string ini = outputs.settingsFile(); !ini.empty())
  {
    writers.push_back({ini, [&outputs, ini] { writeWhole(ini, outputs.settings.toIni()); }});
  }
  if (!outputs.labelled_map.empty())
  {
    writers.push_back({outputs.labelled_map,
                       [&] { writeLabelledMap(builder.labelledMap(), outputs.labelled_map); }});
  }
  return writers;
}
}  // namespace

std::string writeEach(const std::vector<FileWriter>& writers)
{
  std::string failures;
  for (const FileWriter& writer : writers)
  {
    try
    {
      writer.write();
    }
    catch (const MapStopped&)
    {
      throw;
    }
    catch (const UserError& error)
    {
      appendWord(failures, error.what(), "; ");
    }
    catch (const std::exception& error)
    {
      appendWord(failures, writer.name + ": " + error.what(), "; ");
    }
  }
  return failures;
}

void requireValidExports(const MapOutputs& outputs)
{
  const MapExportOptions& exports = outputs.exports;
  validate(exports, "map_export");
  const bool in_tiles = exports.tile_size > 0 && !cloudsOf(outputs).empty();
  if (in_tiles && exports.normals && exports.normal_radius > TileMap::margin)
  {
    throw UserError(
        formatted("[map_export] normal_radius = %g is too large for tiles; use at most %g (m), or "
                  "tile_size = 0 for one file",
                  exports.normal_radius, TileMap::margin));
  }
}

MapProducts productsFor(const MapOutputs& outputs)
{
  MapProducts products;
  products.whole_map = outputs.needWholeMap();
  products.labelled_map = !outputs.labelled_map.empty();
  products.scan_store = outputs.needScans() ? outputs.maps.front() + ".scans" : "";
  const std::string ini = outputs.settingsFile();
  products.temporary_folder =
      fs::absolute(ini.empty() ? outputs.labelled_map : ini).parent_path().string();
  return products;
}

MapReport writeMapOutputs(MapBuilder& builder, const MapOutputs& outputs, MapListener& listener)
{
  warnOfOrigin(builder.origin(), outputs, listener);
  warnOfReach(builder.reach(), listener);
  MapReport report;
  report.keyframes = builder.keyframes();
  report.skipped = builder.skipped();
  report.unregistered = builder.unregistered();
  const bool whole = outputs.needWholeMap();
  if (whole)
  {
    report.voxel_size = builder.map().voxelSize();
    report.points = builder.map().pointCount();
  }
  else if (!outputs.maps.empty())
  {
    report.voxel_size = builder.options().map.voxel_size;  // the tiles are counted when written
  }
  else
  {
    report.points = builder.labelledMap().points().size();
  }
  report.problem = writeEach(writersOf(outputs, builder, listener, report));
  if (!builder.memoryProblem().empty())
  {
    listener.warn(builder.memoryProblem());
  }
  return report;
}
}  // namespace dyslam
