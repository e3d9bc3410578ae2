// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace dyslam
{
/** Reads report.json, an object, of a run's folder; nothing if it is missing, since the run did not
 * finish. \throws UserError. */
[[nodiscard]] std::optional<nlohmann::ordered_json> readRunReport(const std::string& folder);
}  // namespace dyslam
