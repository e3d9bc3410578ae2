// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/KittiExport.h>

#include <string>

#include "../common/AppMain.h"
#include "../common/ConversionReport.h"
#include "Arguments.h"

namespace
{
using namespace dyslam;

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
  const KittiExportOptions& o = arguments.options;
  const std::string written = arguments.output + (o.poses_only ? "/poses/" : "/sequences/") +
                              o.sequence + (o.poses_only ? ".txt" : "");
  ConversionResult result =
      convertWithProgress("rawlog2kitti", arguments.input, arguments.output, arguments.quiet,
                          [&](const ConversionProgress& progress)
                          { return exportKitti(arguments.input, arguments.output, o, progress); });
  result.notes.insert(result.notes.begin(), arguments.missing.begin(), arguments.missing.end());
  report(result, written, o.trajectory.empty());
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
