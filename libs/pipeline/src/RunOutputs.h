// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/FrameCopy.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "CheckpointWriter.h"
#include "JobThread.h"
#include "KeptFiles.h"
#include "OutputFolder.h"
#include "RunOutput.h"
#include "SavedRun.h"

namespace dyslam
{
/** Everything that a run writes into its folder.
 *
 * An output that fails (disk full) writes no more; the others continue, and the reasons are in
 * RunResults::failures at the end. */
class RunOutputs
{
 public:
  /** Makes the outputs; nothing is written yet. \throws UserError for bad options. */
  RunOutputs(const SlamRunSettings& settings,
             ConfigLoader& config,
             const std::vector<RunOutputKind>& kinds = runOutputKinds());

  /** Makes the folder, removes what an earlier run left and opens the files. \throws UserError. */
  void open();
  /** Takes the frame; slow outputs write in another thread. */
  void add(Frame frame);
  /** Decides which outputs get final frames: those that want them. In runs that do not track again,
   * outputs that want no more than their points get causal frames instead, which have the same
   * objects; and so do those that want the intensities, unless an output wants more.
   * \return what the outputs need of final frames; `none` if none gets them */
  FrameParts chooseFrames(bool tracks_again);
  /** The same frame again, later, for the outputs that want final moving points. */
  void addFinal(Frame frame);
  /** Seconds between checkpoints, 0: none. */
  [[nodiscard]] double checkpointSeconds() const { return checkpoint_seconds_; }
  /** Between two frames: writes a checkpoint: the results so far, and the state, which gets its
   * final name in the writing thread once all frames so far are written. If that fails, or while
   * the previous state is still being written, it is left for the next checkpoint; a failure is a
   * warning of the run unless a later checkpoint succeeds.
   * \param add_state adds the parts of the state before those of the outputs
   * \param is_last the run is stopped here: waits for the previous state, and finish() leaves this
   *   one and what is needed to resume from it */
  void checkpoint(const std::function<void(StateFileWriter&)>& add_state,
                  const RunResults& results,
                  bool is_last = false);
  /** Instead of open(): goes on with the files of a run that was killed. \throws UserError. */
  void resume(RunToResume& run);
  /** Waiting times of the writing thread and of those that pass frames to it. */
  [[nodiscard]] QueueWaits waits() const { return writer_->waits(); }
  /** Writes the results that are known at the end only; fills the report's files and the
   * failures. */
  void finish(RunResults& results);

 private:
  struct Entry
  {
    std::unique_ptr<RunOutput> output;  //!< null once it has failed
    std::vector<OutputName> names;
    bool slow = false;
    FrameParts final_parts = FrameParts::none;  //!< of final frames; none: it gets causal ones
    std::string failure;                        //!< why it has failed; empty if it has not

    [[nodiscard]] bool getsFinal() const { return final_parts != FrameParts::none; }
  };

  void add(Frame frame, bool is_final);
  /** Hands the frame to the slow or fast outputs that want final or causal ones. */
  void addTo(const Frame& frame, bool slow, bool is_final);
  /** Adds those files of the output that are there. */
  void listFiles(const Entry& entry, SlamRunReport& report) const;
  /** Waits for all that the writing thread has to do. */
  void waitForWriter();
  /** In the writing thread, behind the last state. */
  void keepFiles();
  /** At the end: removes the state, unless the run was stopped and can be resumed. */
  void removeState();
  /** State of the outputs of one thread. */
  void exchangeState(StateArchive& archive, bool slow);

  std::string folder_;
  bool force_;
  double checkpoint_seconds_ = 0;
  const ConfigLoader& config_;       // other parts of the run load theirs until open()
  std::vector<std::string> inputs_;  //!< files that the run reads
  std::unique_ptr<OutputFolder> made_;
  std::vector<OutputName> names_;  //!< of all kinds, those switched off too
  KeptFiles kept_files_;
  bool is_stopped_ = false;      //!< by the last checkpoint
  bool are_files_kept_ = false;  //!< read once the writing thread has ended
  std::vector<Entry> entries_;
  CheckpointWriter checkpoints_;
  std::unique_ptr<JobThread> writer_;  //!< last: its jobs use the entries and checkpoints
};
}  // namespace dyslam
