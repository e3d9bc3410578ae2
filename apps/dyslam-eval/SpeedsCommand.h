// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval speeds`. */
[[nodiscard]] Subcommand speedsCommand(CLI::App& app);
}  // namespace dyslam
