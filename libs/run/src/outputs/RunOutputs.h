// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/FrameCopy.h>
#include <dyslam/pipeline/JobThread.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../checkpoint/CheckpointWriter.h"
#include "../checkpoint/RunToResume.h"
#include "../folder/KeptFiles.h"
#include "../folder/OutputFolder.h"
#include "RunOutput.h"

namespace dyslam
{
/** All outputs that a run writes to its folder.
 *
 * An output that fails (for example on a full disk) is disabled; the others continue, and the
 * reasons are in RunResults::failures at the end. The last state then stays, so that a resumed run
 * writes what failed after it. */
class RunOutputs
{
 public:
  /** Constructs the outputs; nothing is written yet. \throws UserError for bad options. */
  RunOutputs(const SlamRunSettings& settings,
             ConfigLoader& config,
             const std::vector<RunOutputKind>& kinds = runOutputKinds());

  /** Creates the folder, removes files of an earlier run, opens the outputs. \throws UserError. */
  void open();
  /** Passes a causal frame to the outputs; slow outputs write in another thread. */
  void add(Frame frame);
  /** Decides which outputs get final frames: those that want them. In runs that do not track again,
   * outputs that want no more than their points get causal frames instead, which have the same
   * objects; and so do those that want the intensities, unless an output wants more.
   * \return what the outputs need of final frames; `none` if none gets them */
  FrameParts chooseFrames(bool tracks_again);
  /** The same frame again, later, for the outputs that want final moving points. */
  void addFinal(Frame frame);
  /** Time between checkpoints [s]; 0: none. */
  [[nodiscard]] double checkpointSeconds() const { return checkpoint_seconds_; }
  /** Called between two frames: writes a checkpoint, which is the results so far and the state. The
   * writing thread renames the state once all frames so far are written. If the checkpoint fails,
   * or the previous state is still being written, it is skipped; a failure is a warning of the run
   * unless a later checkpoint succeeds.
   * \param add_state adds the parts of the state before those of the outputs
   * \param is_last the run stops here: waits for the previous state, and finish() keeps this state
   *   and the files needed to resume from it */
  void checkpoint(const std::function<void(StateFileWriter&)>& add_state,
                  const RunResults& results,
                  bool is_last = false);
  /** Called instead of open(): continues the files of a killed run. \throws UserError. */
  void resume(RunToResume& run);
  /** Waiting times of the writing thread and of the threads that pass frames to it. */
  [[nodiscard]] QueueWaits waits() const { return writer_->waits(); }
  /** Writes the results that are known only at the end; sets the report's files and the
   * failures. */
  void finish(RunResults& results);

 private:
  struct Entry
  {
    std::unique_ptr<RunOutput> output;  //!< null: it has failed
    std::vector<OutputName> names;
    bool slow = false;
    FrameParts final_parts = FrameParts::none;  //!< of final frames; none: it gets causal ones
    std::string failure;                        //!< why it has failed; empty if it has not
    bool is_lost = false;  //!< it had failed when the last state was saved, or cannot be continued

    [[nodiscard]] bool getsFinal() const { return final_parts != FrameParts::none; }
  };

  void add(Frame frame, bool is_final);
  /** Passes a frame to the slow or fast outputs that need final or causal frames. */
  void addTo(const Frame& frame, bool slow, bool is_final);
  /** Adds the existing files of the output. */
  void listFiles(const Entry& entry, SlamRunReport& report) const;
  /** Waits for all that the writing thread has to do. */
  void waitForWriter();
  /** Called in the writing thread, after the last state. */
  void keepFiles();
  /** Called at the end: removes the state, unless the run can be resumed and was stopped, or lacks
   * outputs that a resumed run can write. \param at_end the run reached the end of the recording */
  void removeState(bool at_end);
  /** State of the outputs of one thread. */
  void exchangeState(StateArchive& archive, bool slow);
  /** Loads the state of an output. A slow one ends if it cannot be continued: its file was removed
   * when it could not be written. \throws UserError for other outputs. */
  void loadState(const std::string& bytes, Entry& entry) const;
  /** Tells of an output that has ended before the run. */
  void warnOfLost(const Entry& entry) const;

  std::string folder_;
  bool force_;
  double checkpoint_seconds_ = 0;
  const ConfigLoader& config_;       // other parts of the run load sections until open()
  std::vector<std::string> inputs_;  //!< files that the run reads
  std::unique_ptr<OutputFolder> made_;
  std::vector<OutputName> names_;  //!< names of all outputs, also of those switched off
  KeptFiles kept_files_;
  bool is_stopped_ = false;      //!< the last checkpoint stopped the run
  bool are_files_kept_ = false;  //!< read once the writing thread has ended
  std::vector<Entry> entries_;
  std::function<void(const std::string&)> warn_;  //!< may be empty
  CheckpointWriter checkpoints_;
  std::unique_ptr<JobThread> writer_;  //!< last: its jobs use the entries and checkpoints
};
}  // namespace dyslam
