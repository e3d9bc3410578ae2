// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include <dyslam/base/Config.h>
#include <dyslam/formats/RecordingOrigin.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapbuilder/MapRun.h>

#include <filesystem>

#include "../common/OutputOptions.h"
#include "../common/RangeFlags.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** The calibration of the KITTI recording that a rawlog was converted from: calib.txt of an
 * odometry sequence, or the folder of the day of a raw drive; empty if there is none. */
std::string calibOf(const std::string& rawlog)
{
  const auto origin = originOfRecording(rawlog);
  if (!origin || origin->input.empty())
  {
    return "";
  }
  const fs::path recording = fs::path(origin->input).lexically_normal();
  const fs::path folder = recording.has_filename() ? recording : recording.parent_path();
  if (fs::is_regular_file(folder / "calib.txt"))
  {
    return (folder / "calib.txt").string();
  }
  const fs::path day = folder.parent_path();
  return fs::is_regular_file(day / "calib_cam_to_cam.txt") &&
                 fs::is_regular_file(day / "calib_velo_to_cam.txt")
             ? day.string()
             : "";
}

/** Takes the range and the lidars of the run, of whose scans its poses are. */
void completeSource(const std::string& run, KittiExportOptions& options)
{
  const fs::path settings = fs::path(run) / run_files::settings;
  if (!fs::is_regular_file(settings))
  {
    return;
  }
  const Config config = Config::fromFile(settings.string());
  const auto source = ConfigLoader(config).get<RawlogSourceOptions>("input");
  if (options.skip_first_n == 0 && options.only_first_n == 0 && options.start == 0 &&
      options.end == 0)
  {
    static_cast<ScanRange&>(options) = source;
  }
  options.sensor_label = options.sensor_label.empty() ? source.sensor_label : options.sensor_label;
  options.further_lidars =
      options.further_lidars.empty() ? source.further_lidars : options.further_lidars;
}
}  // namespace

void declare(CLI::App& app, Arguments& arguments)
{
  KittiExportOptions& o = arguments.options;
  app.description(
      "Writes a rawlog as a sequence of KITTI odometry and SemanticKITTI: scans, times, poses, "
      "labels");
  app.add_option("-i,--input", arguments.input, "rawlog");
  app.add_option(
      "--run", arguments.run,
      "DIR: output folder of dyslam, which names the rawlog, has the trajectory, and "
      "knows the calib.txt of a KITTI sequence; --input, --trajectory and --calib replace "
      "its own");
  addOutputFolder(app, "-o,--output", arguments.output,
                  "folder that gets sequences/NN and poses/NN.txt")
      ->required();
  app.add_option("--sequence", o.sequence, "name of the sequence")->capture_default_str();
  app.add_option(
      "--trajectory", o.trajectory,
      "poses of the vehicle, TUM or KITTI (default: those of --run, else the rawlog's ground "
      "truth); they are written "
      "in the camera's frame, as KITTI's tools read them");
  app.add_option("--calib", o.calib,
                 "calibration of KITTI odometry or tracking, or folder of raw's (default: that of "
                 "--run, else camera axes at the lidar)");
  app.add_option("--tracks", o.tracks,
                 "tracks.txt of a run: tracks/NN.txt gets its boxes in the camera's frame, in the "
                 "columns of KITTI's tracking results");
  app.add_option("--sensor-label", o.sensor_label,
                 "regex for the lidar's sensor label (default: as in the run, else the first "
                 "lidar)");
  app.add_option("--further-lidars", o.further_lidars,
                 "regex for the labels of further lidars, whose scans are merged with those of the "
                 "first, in its frame (default: as in the run, else none)");
  app.add_flag("--no-scans", o.no_scans, "only times, calibration and poses");
  app.add_flag("--poses-only", o.poses_only,
               "only poses/NN.txt, as the server of KITTI odometry reads them");
  app.add_flag("--force", o.force, "replace an earlier sequence or file of the name");
  app.add_flag("--deskew", o.deskew,
               "deskew the scans along their poses, as KITTI's are (default: as recorded, with "
               "point_times/ beside them for dyslam)");
  app.add_flag("--rings", o.rings, "NNNNNN.ring beside each scan, a byte for each point");
  declareRange(app, o, "convert");
  app.add_flag("-q,--quiet", arguments.quiet, "no progress");
}

void completeFrom(const std::string& run, Arguments& arguments)
{
  KittiExportOptions& o = arguments.options;
  RecordingOnTrajectory recording;
  recording.rawlog = arguments.input;
  recording.trajectory = o.trajectory;
  completeFromRun(run, recording);
  arguments.input = recording.rawlog;
  o.trajectory = recording.trajectory;
  completeSource(run, o);
  if (o.calib.empty())
  {
    o.calib = calibOf(arguments.input);
  }
  if (o.calib.empty())
  {
    arguments.missing.push_back(run +
                                ": was not converted from a KITTI recording with a calibration; "
                                "the camera is at the lidar (--calib gives its place)");
  }
}
}  // namespace dyslam
