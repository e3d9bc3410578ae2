// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval kitti-mot`. */
[[nodiscard]] Subcommand kittiMotCommand(CLI::App& app);
}  // namespace dyslam
