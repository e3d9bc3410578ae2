// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval run`. */
[[nodiscard]] Subcommand runCommand(CLI::App& app);
}  // namespace dyslam
