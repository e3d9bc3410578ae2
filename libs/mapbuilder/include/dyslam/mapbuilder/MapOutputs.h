// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/mapexport/MapExport.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Files to be written of a map; those without a name are not written. */
struct MapOutputs
{
  std::vector<std::string> maps;  //!< map files; format by the ending, see mapFormatOf()
  MapExportOptions exports;
  std::string picture;     //!< PNG: the map from above, with paths and objects
  std::string comparison;  //!< PNG: map before and after cleaning; several runs: before merging
  std::string
      labelled_map;  //!< `.ply`, `.pcd` or `.bin`: LabelledMap, with a `.label` file beside it
  bool utm = false;  //!< of merged runs: maps in UTM instead of the first run's map frame
  Config settings;   //!< all settings, written as an ini beside the first output

  /** Path beside the first output: `map_tum.txt` for `map.las` and `_tum.txt`; else empty. */
  [[nodiscard]] std::string beside(const std::string& ending) const;
  /** File of the settings; empty without any output but a labelled map. */
  [[nodiscard]] std::string settingsFile() const { return beside(".effective.ini"); }
  /** Whether some output needs the map in memory as a whole: all but clouds in tiles and the
   * labelled map. */
  [[nodiscard]] bool needWholeMap() const;
  /** Whether some output needs the scans again after the map is built. */
  [[nodiscard]] bool needScans() const;
};
}  // namespace dyslam
