// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/mapbuilder/RunScans.h>
#include <dyslam/mapping/HindsightLabels.h>
#include <dyslam/mapping/LabelledMap.h>
#include <dyslam/mapping/MapTiles.h>
#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** How a map is built, whatever it is built of and written to. */
struct MapBuilderOptions
{
  StaticMapOptions map;            //!< voxels and cleaning
  HindsightOptions hindsight;      //!< moving points of runs without labels
  MemoryOptions memory;            //!< memory for the map; beyond it is on the disk
  double keyframe_distance = 1.0;  //!< distance after which a scan is used [m]; 0: all scans
  int threads = 0;                 //!< number of threads; 0: number of cores
};

/** What a MapBuilder makes, and the files that it needs; buildMap() and mergeMaps() set it by the
 * outputs. */
struct MapProducts
{
  bool whole_map = true;         //!< build map()
  bool labelled_map = false;     //!< collect labelledMap()
  bool uncleaned_map = false;    //!< build uncleanedMap()
  std::string scan_store;        //!< file for the scans used; empty: they are not stored
  std::string temporary_folder;  //!< folder of the unnamed file for the map beyond
                                 //!< MapBuilderOptions::memory
};

/** Builds the static map of a recording along a known trajectory, or of several of one place.
 *
 * Keyframes are chosen by distance and rotation from the scans with a pose. Moving points are left
 * out: by the labels of RunScans, else by labels with hindsight, and by the boxes of moving
 * objects. Not thread-safe. */
class MapBuilder
{
 public:
  /** \throws UserError if the scans cannot be stored. */
  explicit MapBuilder(const MapBuilderOptions& options,
                      const MapProducts& products = MapProducts());

  /** Begins a recording, also the first one. \throws UserError as RunScans. */
  void beginRun(const Trajectory& trajectory, const RunScansOptions& options);

  /** First pass over the scans, if there are tracks: see RunScans::noteObjects(). */
  void noteObjects(const Frame& frame) { runs_.back().noteObjects(frame); }
  [[nodiscard]] std::size_t trackedScans() const { return runs_.back().trackedScans(); }

  /** Adds the next scan of the recording. Scans without a pose in the trajectory, and scans that
   * the run could not register, are skipped. \pre beginRun() */
  void add(Frame frame);
  /** To be called after the last scan. */
  void finish();

  /** Origin of all results [m]: the start of the trajectory, in whole kilometres, if it is farther
   * than 10 km from zero, where float32 would round; else 0. */
  [[nodiscard]] const Eigen::Vector3d& origin() const { return origin_; }
  /** Largest distance of a keyframe from the origin [m]. */
  [[nodiscard]] double reach() const { return reach_; }
  [[nodiscard]] const StaticMap& map() const { return map_; }
  /** The map including moving points; null without MapProducts::uncleaned_map. */
  [[nodiscard]] const StaticMap* uncleanedMap() const
  {
    return uncleaned_ ? &uncleaned_->map : nullptr;
  }
  /** The scans of the map; null without MapProducts::scan_store. */
  [[nodiscard]] ScanStore* scans() { return scans_ ? &*scans_ : nullptr; }
  [[nodiscard]] std::size_t keyframes() const { return keyframes_.size(); }
  /** UNIX time of the first scan added, with a pose or not [s]. */
  [[nodiscard]] const std::optional<double>& recorded() const { return recorded_; }
  /** Reason why the map could not be moved to disk; empty if all is well. */
  [[nodiscard]] const std::string& memoryProblem() const { return memory_.file->problem(); }
  [[nodiscard]] ThreadPool& pool() { return pool_; }
  /** Number of scans without a pose. */
  [[nodiscard]] std::size_t skipped() const { return skipped_; }
  /** Number of scans with a pose that the run could not register. */
  [[nodiscard]] std::size_t unregistered() const { return unregistered_; }
  /** Trajectory and objects of each recording. */
  [[nodiscard]] const std::deque<RunScans>& runs() const { return runs_; }
  [[nodiscard]] const MapBuilderOptions& options() const { return options_; }
  /** Labelled points, by the labels' folder and the boxes of moving objects. */
  [[nodiscard]] const LabelledMap& labelledMap() const { return labelled_; }

 private:
  [[nodiscard]] bool isKeyframe(const Pose& T_map_vehicle) const;
  void insert(const Frame& frame);

  /** Map that includes moving points. */
  struct Uncleaned
  {
    Uncleaned(const StaticMapOptions& options, const MemoryLimit& memory)
        : keyframes(memory), map(options, keyframes)
    {
    }
    KeyframeStore keyframes;
    StaticMap map;
  };

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double reach_ = 0;
  MapBuilderOptions options_;
  MapProducts products_;
  ThreadPool pool_;
  std::deque<RunScans> runs_;
  MemoryLimit memory_;
  KeyframeStore keyframes_;
  StaticMap map_;
  std::unique_ptr<Uncleaned> uncleaned_;
  std::optional<ScanStore> scans_;
  std::optional<HindsightLabels> hindsight_;  // without moving labels
  std::optional<Pose> last_keyframe_;
  std::optional<double> recorded_;
  std::size_t skipped_ = 0;
  std::size_t unregistered_ = 0;
  LabelledMap labelled_;
};
}  // namespace dyslam
