// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/Converters.h>

#include <iostream>
#include <string>

namespace dyslam
{
/** What a converter says in the end: warnings on stderr, one line of counts on stdout. */
inline void report(const ConversionResult& result, const std::string& output)
{
  for (const std::string& warning : result.warnings)
  {
    std::cerr << "warning: " << warning << '\n';
  }
  std::cout << output << ": " << result.scans << " scans, " << result.points << " points";
  if (!result.ground_truth.empty())
  {
    std::cout << "; truth in " << result.ground_truth << ": " << result.poses << " poses"
              << (result.pose_source.empty() ? "" : " (from " + result.pose_source + ")") << ", "
              << result.label_files << " label files, " << result.boxes << " boxes";
  }
  std::cout << '\n';
}
}  // namespace dyslam
