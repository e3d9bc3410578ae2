// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
using Names = std::vector<std::string>;

/** For comparisons whose notes a test does not look at. */
inline void ignore(const std::string& /*note*/) {}
}  // namespace dyslam
