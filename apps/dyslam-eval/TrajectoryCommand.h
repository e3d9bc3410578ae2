// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval trajectory`. */
[[nodiscard]] Subcommand trajectoryCommand(CLI::App& app);
}  // namespace dyslam
