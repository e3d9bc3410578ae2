// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval map`. */
[[nodiscard]] Subcommand mapCommand(CLI::App& app);
}  // namespace dyslam
