// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/Converters.h>

#include <functional>
#include <iostream>
#include <string>

#include "Checks.h"
#include "Progress.h"

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

/** Converts with a line of progress, and says what came of it.
 * \param program its name \param convert does it, reporting how far it is. \throws UserError. */
inline void runConversion(const std::string& program,
                          const std::string& output,
                          bool quiet,
                          const std::function<ConversionResult(const ConversionProgress&)>& convert)
{
  requireFolderOf(output);
  ConversionResult result;
  {
    Progress progress(program, "scans", quiet);
    result = convert([&progress](double fraction, std::size_t scans)
                     { progress.update(fraction, scans); });
    progress.finish(result.scans);
  }
  report(result, output);
}
}  // namespace dyslam
