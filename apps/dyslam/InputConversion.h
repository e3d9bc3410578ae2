// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/RecordingConverter.h>

#include <CLI/CLI.hpp>

#include "../common/SlamArguments.h"

namespace dyslam
{
/** Replaces an input that is no rawlog by `recording.rawlog` in the output folder, which it is
 * converted to, with its ground truth beside it.
 *
 * It is converted in every run: calibration, poses and labels that are read may lie anywhere.
 * `recording.ini` beside it says what it is made of; without that file an earlier recording of
 * the name is only replaced with --force. \throws UserError. */
void convertInput(SlamArguments& a, const RecordingOptions& options);
}  // namespace dyslam
