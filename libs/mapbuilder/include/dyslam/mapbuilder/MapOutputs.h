// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/mapexport/MapExport.h>

#include <optional>
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
  /** Pose of the trajectory's frame (of merged runs, of the first run's map frame) in the frame of
   * the written maps and trajectories; without it they are in that frame. */
  std::optional<Pose> T_fixed_map;
  Config settings;  //!< all settings, written as an ini beside the first output

  /** The trajectory in the frame of the written maps. */
  [[nodiscard]] Trajectory inFixedFrame(Trajectory trajectory) const;
  /** Path beside the first output: `map_tum.txt` for `map.las` and `_tum.txt`; else empty. */
  [[nodiscard]] std::string beside(const std::string& ending) const;
  /** File of the trajectory of a single recording; empty without `T_fixed_map`. */
  [[nodiscard]] std::string trajectoryFile() const { return T_fixed_map ? beside("_tum.txt") : ""; }
  /** File of the settings; empty without any output but a labelled map. */
  [[nodiscard]] std::string settingsFile() const { return beside(".effective.ini"); }
  /** Whether some output needs the map in memory as a whole: all but clouds in tiles and the
   * labelled map. */
  [[nodiscard]] bool needWholeMap() const;
  /** Whether some output needs the scans again after the map is built. */
  [[nodiscard]] bool needScans() const;
};
}  // namespace dyslam
