// SPDX-License-Identifier: BSD-3-Clause
// The first of two passes over a recording: its settings, and where its labels stay for the second.
#pragma once

#include <dyslam/core/Config.h>
#include <dyslam/pipeline/TwoPassRun.h>

#include <string>

namespace dyslam
{
/** A pass that writes labels only. */
[[nodiscard]] RunRequest firstPassOf(const RunRequest& request);

/** The labels that a run with these settings reads; empty for none. */
[[nodiscard]] std::string labelsIn(const Config& config);

/** Whether a run with these settings into that folder is the second pass of one with two: a folder
 * of labels may be of an earlier run. */
[[nodiscard]] bool isSecondPass(const Config& config, const std::string& output);

/** Absolute path of the folder that keeps the labels of the first pass, in the output folder. */
[[nodiscard]] std::string keptLabelsOf(const std::string& output);

/** Moves the labels of the first pass to where the second one, which writes into the same folder,
 * does not replace them. \return keptLabelsOf(). \throws UserError. */
[[nodiscard]] std::string keepLabelsOfFirstPass(const std::string& output);

/** A warning if the passes disagree about the length of the path [m], else empty. */
[[nodiscard]] std::string comparePaths(double first, double second);
}  // namespace dyslam
