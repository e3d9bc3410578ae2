// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace dyslam
{
/** report.json of a run's folder, an object; nothing if there is none: the run did not finish.
 * \throws UserError. */
[[nodiscard]] std::optional<nlohmann::ordered_json> readRunReport(const std::string& folder);
}  // namespace dyslam
