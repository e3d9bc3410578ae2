// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace dyslam
{
/** Frame::index of the scans in a run's `scans.csv` that could not be registered, so that their
 * poses are predicted. \throws UserError "file:line: what" for a table without the columns `frame`
 * and `registered`, and for damaged lines. */
[[nodiscard]] std::set<std::size_t> unregisteredScans(const std::string& path);
}  // namespace dyslam
