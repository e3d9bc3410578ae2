// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/Converters.h>

#include <string>

#include "../common/AppMain.h"
#include "../common/ConversionReport.h"

namespace
{
using namespace dyslam;

struct Arguments
{
  std::string input;
  std::string output;
  ScanConverterOptions options;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments)
{
  ScanConverterOptions& o = arguments.options;
  app.description(
      "Converts a folder of .bin, .pcd or .ply scans, or a Velodyne .pcap, to an MRPT rawlog");
  app.add_option("-i,--input", arguments.input, "folder of scans, or .pcap file")->required();
  app.add_option("-o,--output", arguments.output, "rawlog to write")->required();
  app.add_option("--sensor", o.sensor,
                 "a pcap's lidar: VLP16, HDL32E or HDL64E (default: from the packets); for "
                 "folders, the scans' sensor label");
  app.add_option("--calibration", o.calibration, "Velodyne's XML or YAML, for a pcap");
  app.add_option("--poses", o.poses, "true poses of the lidar, TUM or KITTI, a line for each scan");
  app.add_option("--dt", o.dt, "seconds between scans; default: their own times, else 0.1");
  app.add_flag("--keep-partial", o.keep_partial, "a pcap's broken first and last revolutions, too");
  app.add_option("--skip-first-n", o.skip_first_n, "scans to skip");
  app.add_option("--only-first-n", o.only_first_n, "scans to convert after those");
  app.add_flag("--external-storage", o.external_storage, "clouds in files of their own");
  app.add_flag("-q,--quiet", arguments.quiet, "no progress");
}

void run(const Arguments& arguments)
{
  runConversion(
      "scans2rawlog", arguments.output, arguments.quiet,
      [&](const ConversionProgress& progress)
      { return convertScans(arguments.input, arguments.output, arguments.options, progress); });
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
