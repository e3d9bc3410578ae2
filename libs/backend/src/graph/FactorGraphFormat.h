// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Key.h>

#include <string_view>

namespace dyslam
{
// What reader and writer of factor_graph.txt have in common.
constexpr std::string_view factor_graph_format = "DYSLAM_FACTOR_GRAPH";
constexpr int factor_graph_version = 1;

/** First word of a variable's line. */
[[nodiscard]] std::string_view lineNameOf(VariableKind kind);
}  // namespace dyslam
