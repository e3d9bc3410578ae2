// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/FrameCopy.h>
#include <dyslam/run/SlamRunSettings.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../folder/OutputName.h"
#include "../results/RunResults.h"

namespace dyslam
{
class StateArchive;

/** Arguments of an output. An output's own options are a section of the config. */
struct RunOutputContext
{
  const SlamRunSettings& settings;
  ConfigLoader& config;
  double scene_voxel_size;  //!< side of the cubes with one map point each in the scene [m]
};

/** One kind of result that a run writes to its folder.
 *
 * To add one, derive a class in a file of its own in this folder and give it a row in
 * RunOutputRegistry.cpp; nothing else has to know its name.
 */
class RunOutput
{
 public:
  RunOutput(const RunOutputContext& context, std::vector<OutputName> names);
  virtual ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  /** All files that the output may write. Files of an earlier run are removed, whether the output
   * is switched on or not. */
  [[nodiscard]] const std::vector<OutputName>& names() const { return names_; }

  /** Whether add() is slow: it is then called in another thread, frame by frame in order. Calls of
   * one output never overlap. */
  [[nodiscard]] virtual bool isSlow() const { return false; }

  /** What add() needs of final frames, see Pipeline::onFinal(): `points` for the objects alone; it
   * gets more if others want more. `none`: it gets frames as the causal pipeline leaves them. In a
   * run that does not track again, those that need no more than `intensity` may get causal ones. */
  [[nodiscard]] virtual FrameParts wants() const { return FrameParts::none; }

  // An exception of one of these functions, except open(), ends only this output.

  /** Called before the first frame; the folder has no files of this output. */
  virtual void open() {}
  virtual void add(const Frame& /*frame*/) {}
  /** Called between two frames: writes the results so far, in case the run is killed. Does not
   * change the result of finish(). Not called for slow outputs. */
  virtual void checkpoint(const RunResults& /*results so far*/) {}
  /** Saves or loads the state between frames, including growing files. Loading replaces open() and
   * all frames so far. */
  virtual void exchangeState(StateArchive& /*archive*/) {}
  /** Called after the last frame. */
  virtual void finish(const RunResults& /*results*/) {}

 protected:
  /** Path of `name`, one of names(). \throws std::logic_error for another name. */
  [[nodiscard]] std::string path(const std::string& name) const;
  /** Calls all functions, one per file, even if some fail. \throws UserError with the reasons. */
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
  /** Key of [output] that switches the output on (the default) or off; null: always on. */
  const char* key = nullptr;
  const char* help = nullptr;
  /** Setting that has to be on as well; null: none. */
  bool SlamRunSettings::*flag = nullptr;
  /** Later scans change numbered files of earlier ones, in the folder of the output's first name.
   * Only for slow outputs: their thread keeps these files at the last checkpoint. */
  bool changes_files = false;
};

/** All outputs in the order in which they finish: the most important first. */
[[nodiscard]] std::vector<RunOutputKind> runOutputKinds();
}  // namespace dyslam
