// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval mask`. */
[[nodiscard]] Subcommand maskCommand(CLI::App& app);
}  // namespace dyslam
