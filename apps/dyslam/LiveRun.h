// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/RecordingOptions.h>

#include <functional>
#include <string>

#include "../common/SlamArguments.h"

namespace dyslam
{
/** Runs the pipeline on a live input (isLiveInput()): its scans are written to
 * `recording.rawlog` in the output folder while they arrive, and the run follows this file. A scan
 * for which the run is too slow waits there, so that the results are those of a later run on the
 * file.
 *
 * The first signal ends the recording, and the run processes the rest; the next one ends the run.
 * The end of the run (--end, --only-first-n) ends the recording. An earlier `recording.rawlog` is
 * only replaced with --force, unless it was converted. \param vehicle_frame see LiveRecorderHooks
 * \throws UserError, UnusableResult. */
void runLive(SlamArguments& a,
             const RecordingOptions& options,
             const std::function<void(const std::string&)>& vehicle_frame);
}  // namespace dyslam
