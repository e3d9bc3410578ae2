// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/KittiExport.h>

#include <string>

#include "../common/AppMain.h"
#include "../common/ConversionReport.h"
#include "../common/OutputOptions.h"
#include "../common/RangeFlags.h"

namespace
{
using namespace dyslam;

struct Arguments
{
  std::string input;
  std::string output;
  KittiExportOptions options;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments)
{
  KittiExportOptions& o = arguments.options;
  app.description(
      "Writes a rawlog as a sequence of KITTI odometry and SemanticKITTI: scans, times, poses, "
      "labels");
  app.add_option("-i,--input", arguments.input, "rawlog")->required();
  addOutputFolder(app, "-o,--output", arguments.output,
                  "folder that gets sequences/NN and poses/NN.txt")
      ->required();
  app.add_option("--sequence", o.sequence, "name of the sequence")->capture_default_str();
  app.add_option(
      "--trajectory", o.trajectory,
      "poses of the vehicle, TUM or KITTI (default: the rawlog's ground truth); they are written "
      "in the camera's frame, as KITTI's tools read them");
  app.add_option("--calib", o.calib,
                 "calibration of KITTI odometry or tracking, or folder of raw's (default: camera "
                 "axes at the lidar)");
  app.add_option("--tracks", o.tracks,
                 "tracks.txt of a run: tracks/NN.txt gets its boxes in the camera's frame, in the "
                 "columns of KITTI's tracking results");
  app.add_option("--sensor-label", o.sensor_label,
                 "regex for the lidar's sensor label (default: the first lidar)");
  app.add_option("--further-lidars", o.further_lidars,
                 "regex for the labels of further lidars, whose scans are merged with those of the "
                 "first, in its frame");
  app.add_flag("--no-scans", o.no_scans, "only times, calibration and poses");
  app.add_flag("--deskew", o.deskew,
               "deskew the scans along their poses, as KITTI's are (default: as recorded, with "
               "point_times/ beside them for dyslam)");
  app.add_flag("--rings", o.rings, "NNNNNN.ring beside each scan, a byte for each point");
  declareRange(app, o, "convert");
  app.add_flag("-q,--quiet", arguments.quiet, "no progress");
}

void run(const Arguments& arguments)
{
  const ConversionResult result = convertWithProgress(
      "rawlog2kitti", arguments.input, arguments.output, arguments.quiet,
      [&](const ConversionProgress& progress)
      { return exportKitti(arguments.input, arguments.output, arguments.options, progress); });
  const std::string folder = arguments.output + "/sequences/" + arguments.options.sequence;
  report(result, folder, arguments.options.trajectory.empty());
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
