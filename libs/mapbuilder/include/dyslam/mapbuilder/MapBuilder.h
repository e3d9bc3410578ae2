// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Parallel.h>
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
struct MapBuilderOptions
{
  StaticMapOptions map;
  HindsightOptions hindsight;
  MemoryOptions memory;
  double keyframe_distance = 1.0;  //!< a scan is used after this distance [m], or a turn; 0: all
  int threads = 0;                 //!< 0: the machine's number

  // What else is built, and where. For buildMap() and mergeMaps() it follows from the outputs.
  bool whole_map = true;         //!< build map()
  bool labelled_map = false;     //!< collect labelledMap() as well
  bool uncleaned_map = false;    //!< build uncleanedMap() as well
  std::string scan_store;        //!< keep the scans used in this file; empty: do not
  std::string temporary_folder;  //!< where the map beyond `memory` goes, in a file without a name
};

/** Builds the static map of a recording along a known trajectory, or of several of one place.
 *
 * Of the scans with a pose, keyframes are chosen by distance and turn; what moves in them is left
 * out: by the labels of RunScans, else by labels with hindsight, and the boxes of objects that
 * move. Not thread-safe. */
class MapBuilder
{
 public:
  /** \throws UserError if the scans cannot be stored. */
  explicit MapBuilder(const MapBuilderOptions& options);

  /** The next recording, the first one also. \throws UserError as RunScans. */
  void beginRun(const Trajectory& trajectory, const RunScansOptions& options);

  /** First pass, if there are tracks: RunScans::noteObjects(). */
  void noteObjects(const Frame& frame) { runs_.back().noteObjects(frame); }
  [[nodiscard]] std::size_t trackedScans() const { return runs_.back().trackedScans(); }

  /** The next scan of the recording, in order. Those the trajectory has no pose for are skipped,
   * and those that the run could not register. \pre beginRun() */
  void add(Frame frame);
  /** After the last scan. */
  void finish();

  /** Everything below is relative to this: the start of the trajectory, in whole kilometres, if it
   * starts farther than 10 km from zero, where float32 would round. Else 0. */
  [[nodiscard]] const Eigen::Vector3d& origin() const { return origin_; }
  [[nodiscard]] const StaticMap& map() const { return map_; }
  /** The same with everything that moved; null without `uncleaned_map`. */
  [[nodiscard]] const StaticMap* uncleanedMap() const
  {
    return uncleaned_ ? &uncleaned_->map : nullptr;
  }
  /** The scans that make the map; null without `scan_store`. */
  [[nodiscard]] ScanStore* scans() { return scans_ ? &*scans_ : nullptr; }
  [[nodiscard]] std::size_t keyframes() const { return keyframes_.size(); }
  /** UNIX time of the first scan added, with a pose or not [s]. */
  [[nodiscard]] const std::optional<double>& recorded() const { return recorded_; }
  /** Why the map stayed in memory; empty if all is well. */
  [[nodiscard]] const std::string& memoryProblem() const { return memory_.file->problem(); }
  [[nodiscard]] ThreadPool& pool() { return pool_; }
  /** Scans without a pose. */
  [[nodiscard]] std::size_t skipped() const { return skipped_; }
  /** Scans with a pose that the run could not register. */
  [[nodiscard]] std::size_t unregistered() const { return unregistered_; }
  /** Trajectory and objects of each recording. */
  [[nodiscard]] const std::deque<RunScans>& runs() const { return runs_; }
  [[nodiscard]] const MapBuilderOptions& options() const { return options_; }
  /** The labels are those of the labels' folder and of moving objects' boxes. */
  [[nodiscard]] const LabelledMap& labelledMap() const { return labelled_; }

 private:
  [[nodiscard]] bool isKeyframe(const Pose& T_map_vehicle) const;
  void insert(const Frame& frame);

  /** What moved is in it. */
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
  MapBuilderOptions options_;
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
