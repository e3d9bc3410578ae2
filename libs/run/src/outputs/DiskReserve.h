// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <system_error>

namespace dyslam
{
/** Free space of the disk of a folder [bytes]; the largest number if it is not known. */
using FreeSpace = std::function<std::uintmax_t(const std::string& folder)>;

[[nodiscard]] inline std::uintmax_t freeSpaceOf(const std::string& folder)
{
  std::error_code ignored;
  return std::filesystem::space(folder, ignored).available;  // -1 on failure
}

/** Free space that is kept for what a run writes at its end: trajectory, graph, map, report. Their
 * sizes are not known before; that of the map, the largest, grows with the scans. */
constexpr std::uintmax_t diskReserve(std::size_t scans)
{
  constexpr std::uintmax_t least = 8 << 20;      // [bytes]
  constexpr std::uintmax_t per_scan = 64 << 10;  // [bytes]
  return least + per_scan * scans;
}
}  // namespace dyslam
