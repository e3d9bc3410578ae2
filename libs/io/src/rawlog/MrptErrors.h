// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <string>

namespace dyslam
{
/** The line of an MRPT exception's text that says what happened. */
[[nodiscard]] inline std::string messageOf(const std::exception& error)
{
  const std::string text = error.what();
  const std::string marker = "Message: ";
  const auto at = text.find(marker);
  const std::string tail = at == std::string::npos ? text : text.substr(at + marker.size());
  return tail.substr(0, tail.find('\n'));
}
}  // namespace dyslam
