// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <string>

namespace dyslam
{
/** Value of an environment variable; empty if it is not set. */
[[nodiscard]] inline std::string environmentValue(const std::string& name)
{
  const char* value = std::getenv(name.c_str());
  return value == nullptr ? "" : value;
}
}  // namespace dyslam
