// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval curves`. */
[[nodiscard]] Subcommand curvesCommand(CLI::App& app);
}  // namespace dyslam
