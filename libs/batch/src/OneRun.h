// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/batch/Batch.h>

#include <functional>
#include <string>
#include <vector>

namespace dyslam::batch
{
enum class RunEnd
{
  by_itself,
  /** By the batch, alone by a signal that asks it to stop, or without room for all results: the
   * next batch resumes it. */
  stopped,
  killed  //!< ended by another signal
};

/** The name that dyslam begins its error lines with. */
constexpr const char* program_name = "dyslam";

/** Runs dyslam on one recording, with manifest and log. \param cores cores to use \param stop
 * polled; true ends the run \param[in,out] result has work and attempts so far; gets the result of
 * the run */
RunEnd runOne(const BatchSettings& settings,
              const std::vector<int>& cores,
              const std::function<bool()>& stop,
              BatchResult& result);

/** Records a run that could not be started or ended, if the folder belongs to a batch. Throws
 * nothing: if the manifest cannot be written, its `reason` says so. */
void recordFailure(const std::string& folder, Manifest& manifest);
/** Share of a run's work that is done, by the last progress in its log, from 0 to 1. The conversion
 * before the run counts as a part of it, and so does each of two passes.
 * \param log file \param arguments of dyslam */
[[nodiscard]] double shareOfRun(const std::string& log,
                                const std::string& recording,
                                const std::vector<std::string>& arguments);
/** Folder that the run of a recording writes to while it is running. */
[[nodiscard]] std::string workFolder(const BatchSettings& settings, const Recording& recording);
/** Arguments of dyslam for a recording, but for -i, -o and --force. */
[[nodiscard]] std::vector<std::string> argumentsFor(const BatchSettings& settings,
                                                    const Recording& recording);
/** BatchSettings::common, with the arguments of the conversion if the recording is converted. */
[[nodiscard]] Work commonWorkFor(const BatchSettings& settings, const Recording& recording);
}  // namespace dyslam::batch
