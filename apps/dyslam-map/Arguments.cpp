// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapexport/MapFormat.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"

namespace dyslam
{
namespace
{
/** \throws UserError for a file that a run wrote. */
void requireNotOfRun(const std::string& output)
{
  if (isFileOfRun(output))
  {
    throw UserError(output +
                    ": is a file of the run in this folder; choose another name, or --force");
  }
}

/** Makes the file's folder. \throws UserError for a file that a run wrote, and where none can be
 * written, before the map is built. */
void prepareOutput(const std::string& file, bool force)
{
  if (file.empty())
  {
    return;
  }
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (!force)
  {
    requireNotOfRun(file);
  }
  if (!folder.empty())
  {
    makeFolder(folder.string(), "choose another --output");
  }
  requireWritable(file);
}

/** The file of the poses with --map-pose of a single recording; else empty. \throws UserError if it
 * would replace those that are read. */
std::string trajectoryFile(const Arguments& a)
{
  const std::string poses = a.inputs.runs.empty() ? a.outputs.trajectoryFile() : "";
  if (!poses.empty() && isSamePath(poses, a.inputs.recording.trajectory))
  {
    throw UserError(poses +
                    ": would be replaced by its poses in the frame of --map-pose; choose "
                    "another name for the first output");
  }
  return poses;
}

void declareRecordings(CLI::App& app, Arguments& a)
{
  app.add_option("-i,--input", a.inputs.recording.rawlog, "rawlog of 3D LiDAR scans");
  app.add_option("--trajectory", a.inputs.recording.trajectory,
                 "poses of the scans: TUM, or KITTI line by line");
  app.add_option_function<std::string>(
         "--poses-of",
         [&a](const std::string& body) { a.inputs.recording.of_lidar = body == "lidar"; },
         "what the poses are of: vehicle (default) or lidar, as KISS-ICP and others write them")
      ->check(CLI::IsMember({"vehicle", "lidar"}));
  app.add_option("--time-offset", a.inputs.recording.time_offset,
                 "added to the time stamps of the poses (TUM) [s]: for clocks that differ");
  app.add_option(
      "--run", a.inputs.run,
      "DIR: output folder of dyslam, which names the recording and has trajectory, settings, "
      "labels and tracks; --input, --trajectory, --config, --labels and --tracks replace its own");
  app.add_option(
      "--merge", a.inputs.runs,
      "RUN RUN...: merge the output folders of several runs of one place, in order of time, to one "
      "map and a trajectory each in the first run's frame, instead of --input and --trajectory "
      "(RUN=RAWLOG where the recording was moved)");
  app.add_option(
      "--map-pose", a.map_pose,
      "'x y z yaw pitch roll' [m, deg]: pose of the trajectory's frame (with --merge, of the first "
      "run's map frame) in the frame of the map files, for coordinates of your own (default: both "
      "are one)");
  app.add_flag(
      "--utm", a.outputs.utm,
      "with --merge: map files in UTM, if a run has satellite positions; .las states the zone");
}

void declareOutputs(CLI::App& app, Arguments& a)
{
  addOutputFile(app, "-o,--output", a.outputs.maps,
                "map file, any number of them: " + mapFormatsHelp());
  app.add_flag("--full", a.given.full,
               "clouds hold every static point (map_export.full_resolution)");
  addOutputFile(app, "--picture", a.outputs.picture,
                "F.png: the map from above with paths and objects");
  addOutputFile(app, "--compare", a.outputs.comparison,
                "F.png: the map with everything that moved beside the clean one; what was removed "
                "is red");
}

void declareMoving(CLI::App& app, Arguments& a)
{
  app.add_option("--labels", a.inputs.recording.scans.labels,
                 "folder of .label files: moving points are left out");
  app.add_option("--tracks", a.inputs.recording.scans.tracks,
                 "tracks.txt: moving objects are left out, by tracks.csv beside it those that are "
                 "dynamic at some time, otherwise those that move by more than 1 m");
}

void declareSettings(CLI::App& app, Arguments& a)
{
  app.add_option(
      "-c,--config", a.given.config,
      "ini file with [map], [labels], [preprocess], [input], [map_export], [memory] and "
      "backend.keyframe_distance (default: effective.ini of the run or beside the trajectory, else "
      "the shipped one that fits the sensor)");
  app.add_option("--set", a.given.assignments, "one setting, overrides the ini; repeatable")
      ->type_name("SECTION.KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  app.add_option("--keyframe-distance", a.given.keyframe_distance,
                 "a scan is used after this distance [m], or a turn of 0.17 rad; 0: every scan; "
                 "default: the ini's backend.keyframe_distance, else 1")
      ->check(notNegative());
  app.add_option("--tolerance", a.inputs.recording.scans.tolerance,
                 "largest difference of time stamps where the pose of a scan cannot be "
                 "interpolated [s]")
      ->check(notNegative())
      ->capture_default_str();
}

/** Flags that do not go together. */
void excludeFlags(CLI::App& app)
{
  CLI::Option* merge = app.get_option("--merge");
  for (const char* single :
       {"--input", "--trajectory", "--poses-of", "--time-offset", "--labels", "--tracks",
        "--skip-first-n", "--only-first-n", "--start", "--end", "--labelled-map", "--run"})
  {
    merge->excludes(app.get_option(single));
  }
  CLI::Option* utm = app.get_option("--utm");
  utm->needs(merge);
  utm->excludes(app.get_option("--compare"));  // which shows each run in its own frame
  utm->excludes(app.get_option("--map-pose"));
  app.get_option("--time-offset")->needs(app.get_option("--trajectory"));
  app.get_option("--run")->excludes(app.get_option("--labelled-map"));  // a run has no true labels
  app.get_option("--poses-of")->needs(app.get_option("--trajectory"));
}
}  // namespace

void declare(CLI::App& app, Arguments& a)
{
  app.description(
      "Builds the static map of a rawlog along a trajectory, or one map of several runs");
  declareRecordings(app, a);
  declareOutputs(app, a);
  declareMoving(app, a);
  declareSettings(app, a);
  declareRange(app, a.inputs.range, "use");
  addOutputFile(
      app, "--labelled-map", a.outputs.labelled_map,
      "also write all points with the true labels of --labels or --tracks (F.ply, F.pcd or F.bin, "
      "and F.label beside it): the reference for dyslam-eval map");
  app.add_option("--threads", a.builder.threads, "0: all cores")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app.add_flag("--force", a.force, "replace files that a run wrote");
  app.add_flag("-q,--quiet", a.quiet, "no progress");
  excludeFlags(app);
}

void checkOutputs(const Arguments& a)
{
  if (a.inputs.runs.empty() &&
      (a.inputs.recording.rawlog.empty() || a.inputs.recording.trajectory.empty()))
  {
    throw UserError(
        std::string(a.inputs.recording.rawlog.empty() ? "--input" : "--trajectory") +
        " is required: give a recording and its trajectory, --run DIR, or --merge RUN RUN "
        "(see dyslam-map --help)");
  }
  if (a.outputs.maps.empty() && a.outputs.labelled_map.empty() && a.outputs.picture.empty() &&
      a.outputs.comparison.empty())
  {
    throw UserError("nothing to write: give at least one --output");
  }
  if (!a.inputs.runs.empty() && a.outputs.T_fixed_map && !a.outputs.comparison.empty())
  {
    throw UserError("--compare shows merged runs in their map frames; leave it out, or --map-pose");
  }
  for (const auto& path : {a.outputs.picture, a.outputs.comparison})
  {
    if (!path.empty() && lowerExtension(path) != ".png")
    {
      throw UserError(path + ": pictures are .png");
    }
    if (!path.empty() && isGridImage(path))
    {
      throw UserError(path + ": is the image of the occupancy grid " +
                      std::filesystem::path(path).replace_extension(".yaml").string() +
                      "; choose another name for the picture");
    }
  }
  for (const auto& path : a.outputs.maps)
  {
    (void)mapFormatOf(path);
  }
  if (!a.outputs.labelled_map.empty() && !isCloudFile(a.outputs.labelled_map))
  {
    throw UserError("--labelled-map " + a.outputs.labelled_map +
                    ": the ending is none of .ply, .pcd and .bin");
  }
  if (!a.outputs.labelled_map.empty() && a.inputs.recording.scans.labels.empty() &&
      a.inputs.recording.scans.tracks.empty())
  {
    throw UserError("--labelled-map " + a.outputs.labelled_map +
                    ": nothing says what moves; give --labels or --tracks");
  }
  std::vector<std::string> files = a.outputs.maps;
  files.insert(files.end(), {a.outputs.picture, a.outputs.comparison, a.outputs.labelled_map,
                             trajectoryFile(a)});
  for (const auto& file : files)
  {
    prepareOutput(file, a.force);
  }
}
}  // namespace dyslam
