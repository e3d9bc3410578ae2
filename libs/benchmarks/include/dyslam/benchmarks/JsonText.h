// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace dyslam
{
/** The JSON value as indented text; bytes that are no UTF-8 (as in names of folders) become U+FFFD.
 */
[[nodiscard]] inline std::string textOf(const nlohmann::ordered_json& json)
{
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/** The number, or null. */
[[nodiscard]] inline nlohmann::ordered_json orNull(const std::optional<double>& value)
{
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}
}  // namespace dyslam
