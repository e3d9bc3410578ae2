// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/run/SlamRunSettings.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../folder/OutputName.h"
#include "../results/RunResults.h"
#include "FrameRouting.h"

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

/** The thread in which an output gets its frames. */
enum class OutputThread
{
  caller,  //!< the thread that adds the frames to the run, which waits for the output
  writer   //!< the thread for outputs that take long
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

  /** The thread that calls add(): `writer` if add() takes long. Always the same. */
  [[nodiscard]] virtual OutputThread thread() const { return OutputThread::caller; }
  /** The frames that add() needs. Always the same. */
  [[nodiscard]] virtual WantedFrames wants() const { return WantedFrames::causal; }

  // The course of an output: open() or exchangeState(), which loads a state; then add() for each
  // frame, with checkpoint() and exchangeState() between two frames; then finish(). Calls of one
  // output never overlap. An exception of one of these functions, except open(), ends only this
  // output.

  /** Called before the first frame; the folder has no files of this output. */
  virtual void open() {}
  /** Called once for each scan, in the order of the scans, with its causal or its final frame
   * (FrameRouting). The frame exists until add() returns. */
  virtual void add(const Frame& /*frame*/) {}
  /** Called between two frames: writes the results so far, in case the run is killed. Does not
   * change the result of finish(). Not called for outputs of the thread `writer`. */
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
   * Only for outputs of OutputThread::writer, which keeps these files at the last checkpoint. */
  bool changes_files = false;
};

/** All outputs in the order in which they finish: the most important first. */
[[nodiscard]] std::vector<RunOutputKind> runOutputKinds();
}  // namespace dyslam
