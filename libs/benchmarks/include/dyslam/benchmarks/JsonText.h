// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace dyslam
{
/** The value as text, indented; bytes that are no UTF-8 (of a folder's name) become U+FFFD. */
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
