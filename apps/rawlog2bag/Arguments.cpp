// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/mapbuilder/MapRun.h>

#include <filesystem>

#include "../common/OutputOptions.h"
#include "../common/RangeFlags.h"

namespace dyslam
{
namespace
{
/** Completes the map from a run, unless the poses are others. */
void completeMap(const std::string& run, Arguments& arguments)
{
  BagExportOptions& o = arguments.options;
  if (arguments.no_map || !o.map.empty())
  {
    return;
  }
  const std::string map = staticMapOfRun(run);
  const auto own = std::filesystem::path(run) / run_files::trajectory;
  if (map.empty())
  {
    arguments.missing.push_back(
        run + ": has no map_static.pcd or .ply; the bag is without /map (--map FILE gives one)");
  }
  else if (!isSamePath(o.trajectory, own.string()))
  {
    arguments.missing.push_back(map +
                                ": is left out, as it is in the frame of the run's own poses; if "
                                "those of --trajectory are, too, give it with --map");
  }
  else
  {
    o.map = map;
  }
}
/** Completes the covariances of a run's own poses. */
void completeMotions(const std::string& run, BagExportOptions& options)
{
  const std::filesystem::path folder(run);
  const auto isPoses = [&](const char* name)
  { return isSamePath(options.trajectory, (folder / name).string()); };
  const auto motions = folder / run_files::motions;
  if ((isPoses(run_files::trajectory) || isPoses(run_files::odometry)) &&
      std::filesystem::is_regular_file(motions))
  {
    options.motions = motions.string();
  }
}
}  // namespace

void declare(CLI::App& app, Arguments& arguments)
{
  BagExportOptions& o = arguments.options;
  app.description(
      "Writes a rawlog, and the results of a run, as a ROS 2 bag (mcap): scans, transforms, IMU, "
      "satellite positions, objects, path, map");
  app.add_option("-i,--input", arguments.input, "rawlog");
  app.add_option("--run", arguments.run,
                 "DIR: output folder of dyslam, which names the rawlog and has trajectory (with "
                 "covariances), labels, tracks and map; --input, --trajectory (then without its "
                 "map), --labels, --tracks "
                 "and --map replace its own");
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
  declareRange(app, arguments.range, "convert");
  app.add_flag("-q,--quiet", arguments.quiet, "no progress");
}

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
  completeMap(run, arguments);
  completeMotions(run, o);
  if (o.labels.empty() && !o.no_scans)
  {
    arguments.missing.push_back(run +
                                ": has no labels, which dyslam --labels writes; moving points are "
                                "not marked, and the bag is without /points_static");
  }
  // Labels and tracks are of the scans that the run read.
  const auto settings = std::filesystem::path(run) / run_files::settings;
  if (std::filesystem::is_regular_file(settings))
  {
    const Config config = Config::fromFile(settings.string());
    o.source = ConfigLoader(config).get<RawlogSourceOptions>("input");
  }
}
}  // namespace dyslam
