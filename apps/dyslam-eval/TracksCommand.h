// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval tracks`. */
[[nodiscard]] Subcommand tracksCommand(CLI::App& app);
}  // namespace dyslam
