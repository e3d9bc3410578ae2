// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/BagExport.h>
#include <dyslam/mapbuilder/MapRun.h>

#include <filesystem>
#include <string>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/ConversionFlags.h"
#include "../common/ConversionReport.h"
#include "../common/OutputOptions.h"

namespace
{
using namespace dyslam;

struct Arguments
{
  std::string input;
  std::string run;
  std::string output;
  std::string sensor_label;
  std::string further_lidars;
  ScanRange range;
  BagExportOptions options;
  bool no_map = false;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments)
{
  BagExportOptions& o = arguments.options;
  app.description(
      "Writes a rawlog, and the results of a run, as a ROS 2 bag (mcap): scans, transforms, IMU, "
      "satellite positions, objects, path, map");
  app.add_option("-i,--input", arguments.input, "rawlog");
  app.add_option("--run", arguments.run,
                 "DIR: output folder of dyslam, which names the rawlog and has trajectory, labels, "
                 "tracks and map; --input, --trajectory, --labels, --tracks and --map replace its "
                 "own");
  addOutputFile(app, "-o,--output", arguments.output, "bag to write: a .mcap file")->required();
  app.add_flag("--force", o.force, "replace an earlier file");
  app.add_option("--trajectory", o.trajectory,
                 "poses of the vehicle, TUM: /tf from map to base_link, /odometry and /path");
  app.add_option("--labels", o.labels,
                 "folder of .label files (SemanticKITTI): a field 'moving' of the points, and "
                 "/points_static without them");
  app.add_option("--tracks", o.tracks, "tracks.txt of a run: /objects");
  app.add_option("--map", o.map, "map in the frame of the trajectory, .pcd or .ply: /map");
  app.add_flag("--no-map", arguments.no_map, "leave the map out");
  app.add_flag("--no-scans", o.no_scans, "leave the scans out");
  app.add_flag("--static-only", o.static_only, "of the scans only /points_static");
  app.add_option("--sensor-label", arguments.sensor_label,
                 "regex for the lidar's sensor label (default: as in the run, else the first "
                 "lidar)");
  app.add_option("--further-lidars", arguments.further_lidars,
                 "regex for the labels of further lidars, whose scans are merged with those of the "
                 "first, in its frame (default: as in the run, else none)");
  declareRange(app, arguments.range);
  app.add_flag("-q,--quiet", arguments.quiet, "no progress");
}

/** The static map of a run; empty if it has none. */
std::string mapOf(const std::string& run)
{
  for (const char* name : {"map_static.pcd", "map_static.ply"})
  {
    const std::filesystem::path path = std::filesystem::path(run) / name;
    if (std::filesystem::is_regular_file(path))
    {
      return path.string();
    }
  }
  return "";
}

/** Completes what is not given from the folder of a run. \throws UserError. */
void completeFrom(const std::string& run, Arguments& arguments)
{
  BagExportOptions& o = arguments.options;
  RecordingOnTrajectory recording;
  recording.rawlog = arguments.input;
  recording.trajectory = o.trajectory;
  recording.scans.labels = o.labels;
  recording.scans.tracks = o.tracks;
  completeFromRun(run, recording);
  arguments.input = recording.rawlog;
  o.trajectory = recording.trajectory;
  o.labels = recording.scans.labels;
  o.tracks = recording.scans.tracks;
  o.map = o.map.empty() ? mapOf(run) : o.map;
  // Labels and tracks are of the scans that the run read.
  const auto settings = std::filesystem::path(run) / "effective.ini";
  if (std::filesystem::is_regular_file(settings))
  {
    const Config config = Config::fromFile(settings.string());
    o.source = ConfigLoader(config).get<RawlogSourceOptions>("input");
  }
}

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
  const ConversionResult result = convertWithProgress(
      "rawlog2bag", arguments.input, arguments.output, arguments.quiet,
      [&](const ConversionProgress& progress)
      { return exportBag(arguments.input, arguments.output, arguments.options, progress); });
  report(result, arguments.output, arguments.options.trajectory.empty());
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
