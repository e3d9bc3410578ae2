// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/pipeline/JobThread.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../checkpoint/CheckpointWriter.h"
#include "../checkpoint/RunToResume.h"
#include "../folder/KeptFiles.h"
#include "../folder/OutputFolder.h"
#include "DiskReserve.h"
#include "FrameRouting.h"
#include "GuardedOutput.h"
#include "RunOutput.h"

namespace dyslam
{
/** All outputs that a run writes to its folder.
 *
 * An output that fails (for example on a full disk) is disabled; the others continue, and the
 * reasons are in RunResults::failures at the end. Outputs of the writing thread, which are large,
 * end before the disk is full, the least important first, so that the results of the end can be
 * written (diskReserve()). The last state then stays, so that a resumed run writes what failed
 * after it. */
class RunOutputs
{
 public:
  /** Constructs the outputs and decides which frames each of them gets; nothing is written yet.
   * \param objects the frames that have the objects of the results: final ones with a second
   * tracking, else causal ones \throws UserError for bad options. */
  RunOutputs(const SlamRunSettings& settings,
             ConfigLoader& config,
             FrameKind objects,
             const std::vector<RunOutputKind>& kinds = runOutputKinds(),
             FreeSpace free_space = freeSpaceOf);

  /** The parts of final frames that the outputs need; `none`: none of them gets final frames. */
  [[nodiscard]] FrameParts finalParts() const { return routing_.finalParts(); }
  /** Time between checkpoints [s]; 0: none. */
  [[nodiscard]] double checkpointSeconds() const { return checkpoint_seconds_; }

  /** Creates the folder, removes files of an earlier run, opens the outputs. \throws UserError. */
  void open();
  /** Passes a frame to the outputs that get frames of this kind; frames of each kind come in the
   * order of the scans. Outputs of OutputThread::caller have written it when this returns; those of
   * the writing thread share the frame, which exists until all of them have written it. Waits while
   * several frames wait for that thread. */
  void add(FrameKind kind, Frame frame);
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
  /** Whether an output has this thread and gets frames of this kind. */
  [[nodiscard]] bool receives(const GuardedOutput& output,
                              OutputThread thread,
                              FrameKind kind) const;
  /** Ends outputs of the writing thread, which calls this, until the reserve of the disk is free.
   */
  void keepDiskReserve(std::size_t scans);
  /** Passes a frame to the outputs that receive it in this thread, which calls this. */
  void pass(OutputThread thread, FrameKind kind, const Frame& frame);
  /** Files that the outputs must not replace. */
  [[nodiscard]] std::vector<std::string> inputFiles() const;
  /** Writes the results so far of each output of OutputThread::caller. */
  void writeSoFar(RunResults results);
  /** Adds the existing files of the output. */
  void listFiles(const GuardedOutput& output, SlamRunReport& report) const;
  /** Waits for all that the writing thread has to do. */
  void waitForWriter();
  /** Called in the writing thread, after the last state. */
  void keepFiles();
  /** Called at the end: removes the state, unless the run can be resumed and was stopped, or lacks
   * outputs that a resumed run can write. \param at_end the run reached the end of the recording */
  void removeState(bool at_end);
  /** Saves or loads the state of the outputs of one thread. */
  void exchangeState(OutputThread thread, StateArchive& archive);
  /** Tells of an output that has ended before the run. */
  void warnOfLost(const GuardedOutput& output) const;

  std::string folder_;
  bool force_;
  double checkpoint_seconds_ = 0;
  const ConfigLoader& config_;       // other parts of the run load sections until open()
  std::vector<std::string> inputs_;  //!< files that the run reads
  std::unique_ptr<OutputFolder> made_;
  std::vector<OutputName> names_;  //!< names of all outputs, also of those switched off
  KeptFiles kept_files_;
  FreeSpace free_space_;
  bool is_stopped_ = false;             //!< the last checkpoint stopped the run
  bool are_files_kept_ = false;         //!< read once the writing thread has ended
  std::vector<GuardedOutput> outputs_;  //!< those that are on
  FrameRouting routing_{{}, FrameKind::causal};
  std::function<void(const std::string&)> warn_;  //!< may be empty
  CheckpointWriter checkpoints_;
  std::unique_ptr<JobThread> writer_;  //!< last: its jobs use the outputs and checkpoints
};
}  // namespace dyslam
