// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/run/RunSlam.h>

#include <functional>
#include <string>

#include "SlamArguments.h"

namespace dyslam
{
/** Runs one pass, as runSlam() and resumeSlam() do. */
using SlamRunner =
    std::function<SlamRunReport(const SlamRunSettings& settings, const FrameCallback& on_frame)>;

/** If the rawlog is one that an earlier run converted: prints the warnings of that conversion on
 * stderr, and makes them warnings of this run. Does nothing for a resumed run, which has them. */
void repeatConversionWarnings(SlamArguments& a);

/** Runs the pipeline on a rawlog as the arguments say, shows the progress of each pass and prints
 * the result. \param run runs one pass \throws UserError, UnusableResult. */
void runSlamProgram(const std::string& program, const SlamArguments& a, const SlamRunner& run);
}  // namespace dyslam
