// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class CloudFormat;
struct CloudDescription;

/** Kinds of map files; each has one writer (mapbuilder's MapWriting.cpp). */
enum class MapKind
{
  cloud,      //!< MapClouds
  octree,     //!< writeOctomap()
  simplemap,  //!< writeSimplemap()
  scene,      //!< SceneExport of dyslam::io
  grid        //!< writeOccupancyGrid()
};

/** A format of map files, by the ending of its name: all that differs between formats. */
struct MapFormat
{
  const char* ending;  //!< with the dot; upper and lower case count
  MapKind kind;
  /** Layout of a cloud; null for other kinds. */
  std::unique_ptr<CloudFormat> (*make_cloud)(const CloudDescription& layout);
  /** Whether coordinates contain the origin of the map frame; else they are float32 or small keys,
   * and relative to it. */
  bool holds_origin;
  /** Whether it has every static point with MapExportOptions::full_resolution, for which the scans
   * are read again. */
  bool has_every_point;
  const char* help;  //!< what it is; the same text for formats that are listed together
};

/** All formats. */
[[nodiscard]] std::vector<MapFormat> mapFormats();
/** Format of a file. \throws UserError for the ending of no format, naming the nearest. */
[[nodiscard]] MapFormat mapFormatOf(const std::string& path);
/** The formats for a help text: "map.{pcd,ply}: cloud; map.bt: octree". */
[[nodiscard]] std::string mapFormatsHelp();
}  // namespace dyslam
