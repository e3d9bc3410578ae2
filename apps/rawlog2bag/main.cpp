// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/BagExport.h>

#include <string>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/ConversionReport.h"
#include "Arguments.h"

namespace
{
using namespace dyslam;

/** Given flags replace what the run has. */
void applyGiven(const Arguments& arguments, RawlogSourceOptions& source)
{
  const ScanRange& range = arguments.range;
  if (range.skip_first_n != 0 || range.only_first_n != 0 || range.start != 0 || range.end != 0)
  {
    static_cast<ScanRange&>(source) = range;
  }
  if (!arguments.sensor_label.empty())
  {
    source.sensor_label = arguments.sensor_label;
  }
  if (!arguments.further_lidars.empty())
  {
    source.further_lidars = arguments.further_lidars;
  }
}

void run(Arguments& arguments)
{
  if (!arguments.run.empty())
  {
    completeFrom(arguments.run, arguments);
  }
  else if (arguments.input.empty())
  {
    throw UserError("--input or --run is required");
  }
  requireConverted(arguments.input);
  applyGiven(arguments, arguments.options.source);
  if (arguments.no_map)
  {
    arguments.options.map.clear();
  }
  ConversionResult result = convertWithProgress(
      "rawlog2bag", arguments.input, arguments.output, arguments.quiet,
      [&](const ConversionProgress& progress)
      { return exportBag(arguments.input, arguments.output, arguments.options, progress); });
  result.notes.insert(result.notes.begin(), arguments.missing.begin(), arguments.missing.end());
  report(result, arguments.output, arguments.options.trajectory.empty());
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
