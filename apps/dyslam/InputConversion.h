// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/RecordingConverter.h>

#include <CLI/CLI.hpp>

#include "../common/SlamArguments.h"

namespace dyslam
{
/** Converts an input that is no rawlog to `recording.rawlog` in the output folder, with its ground
 * truth beside it, and makes that the input. Its warnings become those of the run, also of a later
 * run that reads `recording.rawlog` (repeatConversionWarnings()).
 *
 * Only the scans of the given range are converted, and all of these are the input of the run.
 * It is converted in every run, since calibration, poses and labels that are read may be anywhere.
 * `recording.ini` beside it names its sources and has the warnings; without this file an earlier
 * recording of the name is only replaced with --force, and so is one that was received from a lidar
 * on the network. \throws UserError. */
void convertInput(SlamArguments& a, const RecordingOptions& options);

/** Checks the settings before an input is converted or recorded, and adds that which merges the
 * scans of its further lidars, unless one is given. \throws UserError. */
void completeSettings(SlamArguments& a, const RecordingOptions& options);
}  // namespace dyslam
