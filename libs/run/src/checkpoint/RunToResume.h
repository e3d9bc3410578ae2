// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "../folder/OutputFolder.h"
#include "SavedRun.h"
#include "StateFile.h"

namespace dyslam
{
/** Parts of the state of a run, which different threads write. */
enum class StatePart
{
  run,  //!< SavedRun
  front_end,
  back_end,        //!< back end and statistics
  caller_outputs,  //!< outputs of OutputThread::caller
  writer_outputs,  //!< outputs of OutputThread::writer
};
constexpr std::size_t state_parts = 5;

/** Locked folder with the state of a run that can be resumed. */
struct RunToResume
{
  /** Of a second pass, the settings have the labels in this folder.
   * \throws UserError if there is no state, it cannot be used, or another run writes there. */
  explicit RunToResume(const std::string& folder);

  /** Loads a part. */
  template <typename Load>
  void load(StatePart part, const Load& load)
  {
    StateArchive archive = file.part(static_cast<std::size_t>(part));
    load(archive);
    archive.requireEnd();
  }

  std::unique_ptr<OutputFolder> lock;
  StateFileReader file;
  SavedRun run;
};
}  // namespace dyslam
