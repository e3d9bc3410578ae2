// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval tables`. */
[[nodiscard]] Subcommand tablesCommand(CLI::App& app);
}  // namespace dyslam
