// SPDX-License-Identifier: BSD-3-Clause
#include "ConversionFlags.h"

#include <map>

#include "Checks.h"

namespace dyslam
{
void declareRange(CLI::App& app, ScanRange& range)
{
  app.add_option("--skip-first-n", range.skip_first_n, "scans to skip");
  app.add_option("--only-first-n", range.only_first_n, "scans to convert after those");
  app.add_option("--start", range.start, "convert scans from this time on [s since the first scan]")
      ->check(notNegative());
  app.add_option("--end", range.end, "convert scans before this time [s since the first scan]")
      ->check(positive());
}

void declareRange(CLI::App& app, ScanRange& range, int& every_n)
{
  declareRange(app, range);
  app.add_option("--every", every_n, "convert every n-th scan only")->check(positive());
}

void declarePoseSource(CLI::App& app, PoseSource& source, const std::string& what)
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
