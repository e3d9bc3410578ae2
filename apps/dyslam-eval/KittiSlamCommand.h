// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval kitti-slam`. */
[[nodiscard]] Subcommand kittiSlamCommand(CLI::App& app);
}  // namespace dyslam
