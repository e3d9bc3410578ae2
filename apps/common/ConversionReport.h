// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Printable.h>
#include <dyslam/io/Converters.h>

#include <functional>
#include <iostream>
#include <string>

#include "Checks.h"
#include "Progress.h"
#include "StopSignals.h"

namespace dyslam
{
/** Final report of a converter: notes and warnings on stderr, one line of counts on stdout.
 * \param are_true whether the poses are ground truth, not an estimate */
inline void report(const ConversionResult& result, const std::string& output, bool are_true = true)
{
  for (const std::string& note : result.notes)
  {
    std::cerr << printable(note) << '\n';
  }
  for (const std::string& warning : result.warnings)
  {
    std::cerr << "warning: " << printable(warning) << '\n';
  }
  std::cout << output << ": " << counted(result.scans, "scan") << ", " << result.points
            << " points";
  if (result.poses + result.label_files + result.boxes > 0)
  {
    std::cout << "; "
              << (are_true
                      ? "truth" +
                            (result.ground_truth.empty() ? "" : " in " + result.ground_truth) + ": "
                      : "")
              << counted(result.poses, "pose")
              << (result.pose_source.empty() ? "" : " (from " + result.pose_source + ")") << ", "
              << result.label_files << " label files, " << result.boxes << " boxes";
  }
  std::cout << '\n';
}

/** Converts with a line of progress. A signal ends it and removes what was written so far.
 * \param program its name \param convert converts, and reports its progress. \throws UserError. */
inline ConversionResult convertWithProgress(
    const std::string& program,
    const std::string& output,
    bool quiet,
    const std::function<ConversionResult(const ConversionProgress&)>& convert)
{
  stopOnSignals();
  Progress progress(program, "scans", quiet);
  ConversionResult result = convert(
      [&progress, &output](double fraction, std::size_t scans)
      {
        progress.update(fraction, scans);
        if (stop_asked)
        {
          throw UserError("stopped after " + std::to_string(scans) + " scans; " + output +
                          " was not written");
        }
      });
  progress.finish(result.scans);
  return result;
}

/** Writes a rawlog with a line of progress, and prints the result.
 * \param force replace an earlier recording and its ground truth \throws UserError. */
inline void runConversion(const std::string& program,
                          const std::string& output,
                          bool force,
                          bool quiet,
                          const std::function<ConversionResult(const ConversionProgress&)>& convert)
{
  requireNewRecording(output, force);
  report(convertWithProgress(program, output, quiet, convert), output);
}
}  // namespace dyslam
