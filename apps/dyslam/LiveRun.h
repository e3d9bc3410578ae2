// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/RecordingOptions.h>

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
 * only replaced with --force, unless it was converted. \throws UserError, UnusableResult. */
void runLive(SlamArguments& a, const RecordingOptions& options);
}  // namespace dyslam
