// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/FrameCopy.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/pipeline/SlamRun.h>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

class Backend;
class RunHistory;

/** Results of a run after its last frame. */
struct RunResults
{
  const Backend* backend = nullptr;
  const StaticMap* map = nullptr;       //!< null if mapping is off
  const RunHistory* history = nullptr;  //!< of all scans
  MapPoints map_points;   //!< of the map; a few millions of them, evenly, if it has more
  Trajectory trajectory;  //!< of the vehicle in the map frame, a pose per frame
  std::vector<SmoothedObject> objects;  //!< smoothed ones of graph and tracks, by scan, then id
  std::map<int, int> merged_tracks;     //!< id of the object of each track that was merged
  Trajectory reference;  //!< ground truth in the map frame, where the recording has it
  std::map<std::string, double> stage_ms;   //!< mean per frame [ms]
  std::map<std::string, double> wait_ms;    //!< of each thread for the others, mean per frame [ms]
  std::map<std::string, double> memory_mb;  //!< by part, at the end; `largest`: of the process
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();  //!< of the run
  SlamRunReport report;               //!< its `files`: those written so far
  std::vector<std::string> failures;  //!< why outputs could not be written

  [[nodiscard]] double runTime() const  //!< so far [s]
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
};

/** A file that an output leaves in the run's folder, or a folder of numbered files. */
struct OutputName
{
  OutputName(const char* file) : name(file) {}
  OutputName(const char* folder, const char* extension_in) : name(folder), extension(extension_in)
  {
  }

  std::string name;
  std::string extension;  //!< of the files 000000.label, 000001.label, ... if it is a folder
};

/** Arguments of an output. An output's own options are a section of the config. */
struct RunOutputContext
{
  const SlamRunSettings& settings;
  ConfigLoader& config;
  double scene_voxel_size;  //!< [m]
};

/** One kind of result that a run leaves in its folder.
 *
 * To add one, derive a class in a file of its own in outputs/ and give it a row in
 * RunOutputRegistry.cpp; nothing else has to know its name.
 */
class RunOutput
{
 public:
  RunOutput(const RunOutputContext& context, std::vector<OutputName> names);
  virtual ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  /** All files that it may write. Those of an earlier run are removed, whether the output is
   * switched on or not. */
  [[nodiscard]] const std::vector<OutputName>& names() const { return names_; }

  /** Whether add() takes long: it is then called in another thread, frame by frame in order. All
   * calls of one output come one after the other either way. */
  [[nodiscard]] virtual bool isSlow() const { return false; }

  /** What add() needs of final frames, see Pipeline::onFinal(): `points` for the objects alone; it
   * gets more if others want more. `none`: it gets frames as the causal pipeline leaves them. In a
   * run that does not track again, those that need no more than `intensity` may get causal ones. */
  [[nodiscard]] virtual FrameParts wants() const { return FrameParts::none; }

  // An exception out of one of these ends this output alone, except in open().

  /** Before the first frame, in the folder without this output's files. */
  virtual void open() {}
  virtual void add(const Frame& /*frame*/) {}
  /** Between two frames: writes the results so far, for a run that is killed. It does not change
   * what finish() writes. Not called for slow outputs. */
  virtual void checkpoint(const RunResults& /*results so far*/) {}
  /** What is kept from frame to frame, and the state of growing files. Loading it stands for open()
   * and all frames so far. */
  virtual void exchangeState(StateArchive& /*archive*/) {}
  /** After the last frame. */
  virtual void finish(const RunResults& /*results*/) {}

 protected:
  /** Where to write `name`, one of names(). \throws std::logic_error for another. */
  [[nodiscard]] std::string path(const std::string& name) const;
  /** Calls all of them, each for one file, whichever fails. \throws UserError with the reasons. */
  static void eachByItself(const std::vector<std::function<void()>>& writers);

 private:
  std::string folder_;
  std::vector<OutputName> names_;
};

using RunOutputFactory = std::unique_ptr<RunOutput>(const RunOutputContext& context);

/** One row of the registry. */
struct RunOutputKind
{
  RunOutputFactory* make;
  /** Key of [output] that switches it on (the default) or off; null: always on. */
  const char* key = nullptr;
  const char* help = nullptr;
  /** Setting that must be on as well; null: none. */
  bool SlamRunSettings::*flag = nullptr;
  /** Later scans change its numbered files of earlier ones; its first name is theirs. For slow
   * outputs: their thread keeps these files at the last checkpoint. */
  bool changes_files = false;
};

/** Every output, in the order in which they finish: the most important first. */
[[nodiscard]] std::vector<RunOutputKind> runOutputKinds();
}  // namespace dyslam
