// SPDX-License-Identifier: BSD-3-Clause
// The first of two passes over a recording: its settings, and the labels for the second pass.
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/run/TwoPassRun.h>

#include <string>

namespace dyslam
{
/** Sets the config of a pass that writes only labels. */
[[nodiscard]] RunRequest firstPassOf(const RunRequest& request);

/** Folder of the labels that a run with these settings reads; empty: none. */
[[nodiscard]] std::string labelsIn(const Config& config);

/** Whether a run with these settings into the folder `output` is a second pass; the labels may also
 * be those of an earlier run. */
[[nodiscard]] bool isSecondPass(const Config& config, const std::string& output);

/** Absolute path of the folder that keeps the labels of the first pass, in the output folder. */
[[nodiscard]] std::string keptLabelsOf(const std::string& output);

/** Moves the labels of the first pass to where the second one, which writes into the same folder,
 * does not replace them. \return keptLabelsOf(). \throws UserError. */
[[nodiscard]] std::string keepLabelsOfFirstPass(const std::string& output);

/** Warning if the path lengths of the two passes [m] disagree, else empty. */
[[nodiscard]] std::string comparePaths(double first, double second);
}  // namespace dyslam
