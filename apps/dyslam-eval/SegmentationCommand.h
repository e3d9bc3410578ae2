// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval segmentation`. */
[[nodiscard]] Subcommand segmentationCommand(CLI::App& app);
}  // namespace dyslam
