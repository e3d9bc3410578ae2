// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PcapSource.h>

#include <string>
#include <utility>
#include <vector>

namespace dyslam::test
{
/** Time between the packets of a synthetic capture: 12 blocks of two firings each [s]. */
inline constexpr double packet_time = 12 * 2 * 55.296e-6;

/** The scans of a capture, and what its reader warned of. */
struct Revolutions
{
  std::vector<Scan> scans;
  std::vector<std::string> warnings;
};

/** Reads a whole capture. */
inline Revolutions revolutionsOf(const std::string& path, const PcapSourceOptions& options = {})
{
  PcapSource source(path, options);
  Revolutions result;
  while (auto scan = source.next())
  {
    result.scans.push_back(std::move(*scan));
  }
  result.warnings = source.warnings();
  return result;
}
}  // namespace dyslam::test
