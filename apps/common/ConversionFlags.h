// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/PoseOrigin.h>
#include <dyslam/io/ScanRange.h>

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "Checks.h"

namespace dyslam
{
/** Which scans of a recording a converter takes. */
inline void declareRange(CLI::App& app, ScanRange& range)
{
  app.add_option("--skip-first-n", range.skip_first_n, "scans to skip");
  app.add_option("--only-first-n", range.only_first_n, "scans to convert after those");
  app.add_option("--start", range.start, "convert scans from this time on [s since the first scan]")
      ->check(notNegative());
  app.add_option("--end", range.end, "convert scans before this time [s since the first scan]")
      ->check(positive());
}

/** The same with a part of these scans. */
inline void declareRange(CLI::App& app, ScanRange& range, int& every_n)
{
  declareRange(app, range);
  app.add_option("--every", every_n, "convert every n-th scan only")->check(positive());
}

/** Whether the errors of the true poses are known to be zero. */
inline void declarePoseSource(CLI::App& app, PoseSource& source, const std::string& what)
{
  const std::map<std::string, PoseSource> words{{"simulated", PoseSource::simulated},
                                                {"gnss_ins", PoseSource::gnss_ins},
                                                {"given", PoseSource::given}};
  app.add_option("--pose-source", source,
                 what +
                     ": simulated (exact), gnss_ins, or given (of unknown accuracy); "
                     "default: by the files")
      ->transform(wordFor(words));
}
}  // namespace dyslam
