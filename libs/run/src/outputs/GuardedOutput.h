// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "RunOutput.h"

namespace dyslam
{
/** An output that ends where it fails, so that the run and its other outputs continue. Once it has
 * ended, its functions do nothing. */
class GuardedOutput
{
 public:
  explicit GuardedOutput(std::unique_ptr<RunOutput> output);

  [[nodiscard]] const std::vector<OutputName>& names() const { return names_; }
  [[nodiscard]] OutputThread thread() const { return thread_; }
  [[nodiscard]] WantedFrames wants() const { return wants_; }

  /** Why the output has ended; empty if it has not. */
  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] bool hasEnded() const { return output_ == nullptr; }
  /** Whether the output failed after the last state was saved, so that a run resumed from it tries
   * again. */
  [[nodiscard]] bool hasFailedSinceState() const { return !failure_.empty() && !is_lost_; }

  /** See RunOutput::open(), which may throw. */
  void open();
  /** See RunOutput::add(). \return false if the output ended now */
  bool add(const Frame& frame);
  /** Ends the output for this reason and removes its file. The numbered files of a folder, each
   * of which is complete, stay. \param folder of the run */
  void end(const std::string& reason, const std::string& folder);
  /** See RunOutput::checkpoint(). Errors are ignored: finish() has them if they persist. */
  void checkpoint(const RunResults& so_far);
  /** See RunOutput::finish(). */
  void finish(const RunResults& results);
  /** Saves or loads whether the output has ended, and its state. One of OutputThread::writer ends
   * if it cannot be continued: its file was removed when it could not be written.
   * \return false if it ended now \throws UserError for other outputs that cannot be continued */
  bool exchangeState(StateArchive& archive);

 private:
  /** Calls an action with the output; an exception ends it. \return false if it ended now */
  bool attempt(const std::function<void(RunOutput&)>& action);
  /** Loads the state of the output. \return see exchangeState() */
  bool loadState(const std::string& bytes);

  std::unique_ptr<RunOutput> output_;  //!< null: it has ended
  std::vector<OutputName> names_;
  OutputThread thread_;
  WantedFrames wants_;
  std::string failure_;
  bool is_lost_ = false;  //!< it had ended when the last state was saved, or cannot be continued
};
}  // namespace dyslam
