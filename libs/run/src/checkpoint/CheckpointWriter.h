// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/pipeline/JobThread.h>

#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "StateFile.h"

namespace dyslam
{
/** Writes the state of a run, one at a time: begun between two frames, finished in the writing
 * thread. A failure is a warning of the run unless a later state succeeds.
 * Thread-safe, but for write() and isWriting(), which one thread calls. */
class CheckpointWriter
{
 public:
  using AddParts = std::function<void(StateFileWriter&)>;

  /** \param folder of the run \param warn gets the first failure; may be empty */
  CheckpointWriter(std::string folder, std::function<void(const std::string&)> warn);

  /** Whether a state is not finished yet. */
  [[nodiscard]] bool isWriting() const { return !state_.expired(); }
  /** Begins a state, which gets its final name once all earlier jobs of the thread are done and
   * their files are on the disk. If that fails, the previous state is kept. \pre not isWriting()
   * \param add_first its first parts, added now \param add_last the others, added in the thread */
  void write(const AddParts& add_first, AddParts add_last, JobThread& thread);

  /** The run continues from a state. */
  void setResumable();
  /** The files do not fit to the state any more, for this reason. */
  void setUnusable(const std::string& reason);
  /** Whether the run can be resumed from a state. */
  [[nodiscard]] bool isResumable() const;
  /** What failed; empty if the last state succeeded. */
  [[nodiscard]] std::string warning() const;

 private:
  /** In the thread. */
  void finish(StateFileWriter& state, const AddParts& add_last);
  /** \param failure empty if a state succeeded */
  void note(const std::string& failure);

  std::string folder_;
  std::function<void(const std::string&)> warn_;
  std::weak_ptr<StateFileWriter> state_;  //!< while it is written
  mutable std::mutex mutex_;              //!< guards the next three
  std::string failure_;                   //!< of the last state
  bool is_resumable_ = false;
  bool has_warned_ = false;
};
}  // namespace dyslam
