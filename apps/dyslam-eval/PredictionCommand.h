// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Subcommand.h"

namespace dyslam
{
/** `dyslam-eval prediction`. */
[[nodiscard]] Subcommand predictionCommand(CLI::App& app);
}  // namespace dyslam
