// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapbuilder/RunFolder.h>
#include <dyslam/run/GivenSettings.h>
#include <dyslam/run/RunSettings.h>
#include <dyslam/run/SlamRun.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <utility>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"

namespace dyslam
{
namespace
{
const std::string warning_mark = "warning: ";  // begins messages that --quiet prints, too

/** Sections of an ini: our own, and those of dyslam, which may have written it. */
std::vector<std::string> knownSections()
{
  std::vector<std::string> known = SlamRun::sections();
  known.insert(known.end(), {"map_export", "merge"});
  return known;
}

/** Sections that --set may change: merged runs have [preprocess] and [input] of their own. */
std::vector<std::string> ownSections(bool merging)
{
  return merging ? std::vector<std::string>{"map",  "labels", "map_export", "memory",
                                            "loop", "solver", "merge"}
                 : std::vector<std::string>{"map",   "labels",     "preprocess",
                                            "input", "map_export", "memory"};
}

/** \param run as given to --merge */
std::string effectiveIniOfRun(const std::string& run)
{
  return (std::filesystem::path(RunArgument(run).folder) / "effective.ini").string();
}

/** The ini of the run that the trajectory is of; empty where it is of none. */
std::string effectiveIniBeside(const std::string& trajectory)
{
  const auto ini = std::filesystem::path(trajectory).parent_path() / "effective.ini";
  return std::filesystem::is_regular_file(ini) ? ini.string() : "";
}

/** The ini of the run that the map is of; empty where it is of none. \throws UserError. */
std::string effectiveIniOf(const Arguments& a)
{
  if (!a.runs.empty())
  {
    return effectiveIniOfRun(a.runs.front());
  }
  return a.run.empty() || !a.config.empty() ? effectiveIniBeside(a.recording.trajectory)
                                            : settingsOfRun(a.run);
}

/** The assignments of --set that the recording is read with. */
std::vector<std::string> inputAssignments(const Arguments& a)
{
  std::vector<std::string> result;
  std::copy_if(a.assignments.begin(), a.assignments.end(), std::back_inserter(result),
               [](const std::string& assignment) { return assignment.rfind("input.", 0) == 0; });
  return result;
}

/** The settings under those of --set: of the ini, of the run, or as dyslam chooses them for the
 * sensor. \param messages where they are from */
Config baseSettings(const Arguments& a, std::vector<std::string>& messages)
{
  const std::string of_run = effectiveIniOf(a);
  if (!a.runs.empty())
  {
    Config merged = readGivenSettings(of_run).ini;
    if (!a.config.empty())
    {
      merged.merge(readGivenSettings(a.config).ini);
    }
    return merged;
  }
  const GivenSettings given =
      readGivenSettings(a.config.empty() ? of_run : a.config, inputAssignments(a));
  if (a.config.empty() && !of_run.empty())
  {
    messages.push_back("settings: " + of_run);
    return given.ini;
  }
  RecordingSettings settings = settingsForRecording(a.recording.rawlog, given);
  ChosenSettings& chosen = settings.chosen;
  messages.push_back(settings.sensor.summary() + "; settings: " + chosen.source);
  if (!chosen.levelling_note.empty())
  {
    messages.push_back("note: " + chosen.levelling_note);
  }
  for (const std::string& warning : chosen.warnings)
  {
    messages.push_back(warning_mark + warning);
  }
  return std::move(chosen.config);
}

/** The scans.csv of the run that the trajectory is of; empty where it is of none. */
std::string scanTableBeside(const std::string& trajectory)
{
  const auto table = std::filesystem::path(trajectory).parent_path() / "scans.csv";
  return !effectiveIniBeside(trajectory).empty() && std::filesystem::is_regular_file(table)
             ? table.string()
             : "";
}

/** Number of the reference system of a run's trajectory in UTM; 0 for other trajectories. */
int referenceSystemOf(const std::string& trajectory)
{
  const std::filesystem::path path(trajectory);
  const auto georeference = path.parent_path() / "georeference.ini";
  return path.filename() == "trajectory_utm.txt" && std::filesystem::is_regular_file(georeference)
             ? readGeoreference(georeference.string()).epsg
             : 0;
}

/** Whether a run wrote the file. */
bool isFileOfRun(const std::string& file)
{
  const std::filesystem::path path(file);
  const auto names = filesOfRun(path.parent_path().string());
  return std::find(names.begin(), names.end(), path.filename().string()) != names.end();
}

/** Number of the reference system of the map files; 0: none. \param given by the settings; 0: none
 * \throws UserError for a given number of a run's trajectory that is not in UTM, or in another
 * zone.
 */
int referenceSystem(int given, const std::string& trajectory)
{
  const int of_trajectory = referenceSystemOf(trajectory);
  if (given != 0 && of_trajectory == 0 && isFileOfRun(trajectory))
  {
    throw UserError("map_export.epsg = " + std::to_string(given) + ": " + trajectory +
                    " is in the map frame of its run; give trajectory_utm.txt, or "
                    "--set map_export.epsg=0");
  }
  requireZone(given, of_trajectory);
  return given != 0 ? given : of_trajectory;
}

/** \throws UserError for a file that a run wrote. */
void requireNotOfRun(const std::string& output)
{
  if (isFileOfRun(output))
  {
    throw UserError(output +
                    ": is a file of the run in this folder; choose another name, or --force");
  }
}

/** Makes the file's folder. \throws UserError for a file that a run wrote. */
void prepareOutput(const std::string& file, bool force)
{
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (!force)
  {
    requireNotOfRun(file);
  }
  if (!folder.empty())
  {
    makeFolder(folder.string(), "choose another --output");
  }
}

/** The one key of [backend] that is used here. */
struct KeyframeOptions : Options
{
  double distance = MapBuilderOptions().keyframe_distance;

  void describe(OptionsVisitor& visitor) override
  {
    visitor.real("keyframe_distance", distance, 0, 1000,
                 "translation since the last keyframe after which a new one is added [m]");
  }
};

double keyframeDistance(const Config& config)
{
  KeyframeOptions options;
  if (config.has("backend", "keyframe_distance"))
  {
    Config only;
    only.set("backend", "keyframe_distance", config.section("backend").at("keyframe_distance"));
    load(options, only, "backend");
  }
  return options.distance;
}

void declareRecordings(CLI::App& app, Arguments& a)
{
  app.add_option("-i,--input", a.recording.rawlog, "rawlog of 3D LiDAR scans");
  app.add_option("--trajectory", a.recording.trajectory,
                 "poses of the scans: TUM, or KITTI line by line");
  app.add_option_function<std::string>(
         "--poses-of", [&a](const std::string& body) { a.recording.of_lidar = body == "lidar"; },
         "what the poses are of: vehicle (default) or lidar, as KISS-ICP and others write them")
      ->check(CLI::IsMember({"vehicle", "lidar"}));
  app.add_option(
      "--run", a.run,
      "DIR: output folder of dyslam, which names the recording and has trajectory, settings, "
      "labels and tracks; --input, --trajectory, --config, --labels and --tracks replace its own");
  app.add_option(
      "--merge", a.runs,
      "RUN RUN...: merge the output folders of several runs of one place, in order of time, to one "
      "map and a trajectory each in the first run's frame, instead of --input and --trajectory "
      "(RUN=RAWLOG where the recording was moved)");
  app.add_flag(
      "--utm", a.outputs.utm,
      "with --merge: map files in UTM, if a run has satellite positions; .las states the zone");
}

void declareOutputs(CLI::App& app, Arguments& a)
{
  addOutputFile(app, "-o,--output", a.outputs.maps,
                "map.{pcd,ply,las,bt,ot,simplemap,3Dscene,png,gridmap}; any number (png: grid with "
                "its yaml)");
  app.add_flag("--full", a.full, "clouds hold every static point (map_export.full_resolution)");
  addOutputFile(app, "--picture", a.outputs.picture,
                "F.png: the map from above with paths and objects");
  addOutputFile(app, "--compare", a.outputs.comparison,
                "F.png: the map with everything that moved beside the clean one; what was removed "
                "is red");
}

void declareMoving(CLI::App& app, Arguments& a)
{
  app.add_option("--labels", a.recording.scans.labels,
                 "folder of .label files: moving points are left out");
  app.add_option("--tracks", a.recording.scans.tracks,
                 "tracks.txt: moving objects are left out, by tracks.csv beside it those that are "
                 "dynamic at some time, otherwise those that move by more than 1 m");
}

void declareSettings(CLI::App& app, Arguments& a)
{
  app.add_option(
      "-c,--config", a.config,
      "ini file with [map], [labels], [preprocess], [input], [map_export], [memory] and "
      "backend.keyframe_distance (default: effective.ini of the run or beside the trajectory, else "
      "the shipped one that fits the sensor)");
  app.add_option("--set", a.assignments, "one setting, overrides the ini; repeatable")
      ->type_name("SECTION.KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  app.add_option("--keyframe-distance", a.keyframe_distance,
                 "a scan is used after this distance [m], or a turn of 0.17 rad; 0: every scan; "
                 "default: the ini's backend.keyframe_distance, else 1")
      ->check(notNegative());
  app.add_option("--tolerance", a.recording.scans.tolerance,
                 "largest difference of time stamps where the pose of a scan cannot be "
                 "interpolated [s]")
      ->check(notNegative())
      ->capture_default_str();
}

void declareRange(CLI::App& app, Arguments& a)
{
  app.add_option("--skip-first-n", a.skip_first_n, "scans to skip")->check(notNegative());
  app.add_option("--only-first-n", a.only_first_n, "scans to use after those; 0: all")
      ->check(notNegative());
  app.add_option("--start", a.start, "use scans from this time on [s since the first scan]")
      ->check(notNegative());
  app.add_option("--end", a.end, "use scans before this time [s since the first scan]")
      ->check(positive());
}

/** Flags that do not go together. */
void excludeFlags(CLI::App& app)
{
  CLI::Option* merge = app.get_option("--merge");
  for (const char* single :
       {"--input", "--trajectory", "--poses-of", "--labels", "--tracks", "--skip-first-n",
        "--only-first-n", "--start", "--end", "--labelled-map", "--run"})
  {
    merge->excludes(app.get_option(single));
  }
  CLI::Option* utm = app.get_option("--utm");
  utm->needs(merge);
  utm->excludes(app.get_option("--compare"));  // which shows each run in its own frame
  app.get_option("--run")->excludes(app.get_option("--labelled-map"));  // a run has no true labels
  app.get_option("--poses-of")->needs(app.get_option("--trajectory"));
}

/** What has a section that --set may not change here, as the end of an error message; empty if
 * nothing is known that has it. */
std::string ownerOf(const std::string& section, bool merging)
{
  const auto has = [&section](const std::vector<std::string>& sections)
  { return std::find(sections.begin(), sections.end(), section) != sections.end(); };
  if (has(ownSections(!merging)))
  {
    return "; the section [" + section + "] is for " +
           (merging ? "maps of a single recording" : "--merge");
  }
  return has(SlamRun::sections()) ? "; the section [" + section + "] belongs to dyslam" : "";
}

/** \param assigned sections of --set \throws UnknownSetting for one that --set may not change. */
void requireOwnSections(const Config& assigned, const Arguments& a)
{
  const bool merging = !a.runs.empty();
  const auto own = ownSections(merging);
  for (const std::string& section : assigned.sectionNames())
  {
    if (std::find(own.begin(), own.end(), section) != own.end())
    {
      continue;
    }
    std::string names;
    for (const std::string& name : own)
    {
      names += (names.empty() ? "" : name == own.back() ? " and " : ", ") + name;
    }
    const auto& [key, value] = *assigned.section(section).begin();
    throw UnknownSetting(value.origin + "=" + value.text + ": dyslam-map has the sections " +
                             names + (merging ? " (--merge)" : ""),
                         ownerOf(section, merging), {"", key, value});
  }
}

/** Settings with which a single recording is read. */
void loadRecording(ConfigLoader& loader, Arguments& a)
{
  a.recording.scans.scan_table = scanTableBeside(a.recording.trajectory);
  a.recording.scans.preprocess = loader.get<PreprocessOptions>("preprocess");
  RawlogSourceOptions& source = a.recording.source;
  source = loader.get<RawlogSourceOptions>("input");
  source.skip_first_n = a.skip_first_n.value_or(source.skip_first_n);
  source.only_first_n = a.only_first_n.value_or(source.only_first_n);
  source.start = a.start.value_or(source.start);
  source.end = a.end.value_or(source.end);
}

/** Settings with which runs are merged. \param messages gets notes about them */
void loadMerger(ConfigLoader& loader, Arguments& a, std::vector<std::string>& messages)
{
  a.merger.loops = loader.get<LoopCloserOptions>("loop");
  if (!a.merger.loops.appearance)
  {
    a.merger.loops.appearance = true;  // as RunMerger does
    messages.emplace_back(
        "note: loop.appearance=false is for single runs: nothing but appearance shows where the "
        "merged ones meet (limits: loop.appearance_...)");
  }
  a.merger.solver = loader.get<FactorGraphOptions>("solver");
  a.merger.merge = loader.get<RunMergerOptions>("merge");
  a.builder.hindsight.hindsight = true;  // as mergeMaps() does
}

/** Settings with which the map is built. \param messages gets notes about them */
void loadSections(ConfigLoader& loader, Arguments& a, std::vector<std::string>& messages)
{
  a.builder.map = loader.get<StaticMapOptions>("map");
  a.builder.hindsight = loader.get<HindsightOptions>("labels");
  if (a.runs.empty())
  {
    loadRecording(loader, a);
  }
  else
  {
    loadMerger(loader, a, messages);
  }
  a.outputs.exports = loader.get<MapExportOptions>("map_export");
  a.builder.memory = loader.get<MemoryOptions>("memory");
}

/** The sections that are loaded, with their defaults. */
Config ownDefaults(Arguments a)
{
  const Config none;
  ConfigLoader loader(none);
  std::vector<std::string> ignored;
  loadSections(loader, a, ignored);
  return loader.effective();
}

/** The settings given by ini, run, sensor and --set. \param messages where they are from
 * \throws UserError. */
Config givenSettings(const Arguments& a, std::vector<std::string>& messages)
{
  Config config = baseSettings(a, messages);
  Config assigned;
  for (const auto& assignment : a.assignments)
  {
    assigned.set(assignment);
  }
  requireOwnSections(assigned, a);
  config.merge(assigned);
  config.requireKnownSections(knownSections());
  return config;
}

/** All settings in use: those that were loaded, as the flags have changed them. \throws UserError
 * for a flag that is out of range. */
Config effectiveSettings(const Config& loaded, const Arguments& a)
{
  Config effective = loaded;
  if (a.runs.empty())
  {
    save(a.recording.source, effective, "input");
  }
  else
  {
    save(a.merger.loops, effective, "loop");
  }
  save(a.builder.hindsight, effective, "labels");
  save(a.outputs.exports, effective, "map_export");
  KeyframeOptions keyframes;
  keyframes.distance = a.builder.keyframe_distance;
  validate(keyframes, "backend");
  save(keyframes, effective, "backend");
  return effective;
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
  declareRange(app, a);
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

void loadConfig(Arguments& a)
{
  std::vector<std::string> messages;
  Config config;
  Config loaded;
  try
  {
    config = givenSettings(a, messages);
    ConfigLoader loader(config);
    loadSections(loader, a, messages);
    loaded = loader.effective();
  }
  catch (const UnknownSetting& error)
  {
    throw error.withSectionsOf(ownDefaults(a));
  }
  a.outputs.exports.full_resolution = a.outputs.exports.full_resolution || a.full;
  a.outputs.exports.epsg = referenceSystem(a.outputs.exports.epsg, a.recording.trajectory);
  a.builder.keyframe_distance =
      a.keyframe_distance ? *a.keyframe_distance : keyframeDistance(config);
  a.outputs.settings = effectiveSettings(loaded, a);
  for (const std::string& message : messages)
  {
    if (!a.quiet || message.rfind(warning_mark, 0) == 0)
    {
      std::fprintf(stderr, "%s\n", printable(message).c_str());
    }
  }
}

void checkOutputs(const Arguments& a)
{
  if (a.runs.empty() && (a.recording.rawlog.empty() || a.recording.trajectory.empty()))
  {
    throw UserError(
        std::string(a.recording.rawlog.empty() ? "--input" : "--trajectory") +
        " is required: give a recording and its trajectory, --run DIR, or --merge RUN RUN "
        "(see dyslam-map --help)");
  }
  if (a.outputs.maps.empty() && a.outputs.labelled_map.empty() && a.outputs.picture.empty() &&
      a.outputs.comparison.empty())
  {
    throw UserError("nothing to write: give at least one --output");
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
  if (!a.outputs.labelled_map.empty() && a.recording.scans.labels.empty() &&
      a.recording.scans.tracks.empty())
  {
    throw UserError("--labelled-map " + a.outputs.labelled_map +
                    ": nothing says what moves; give --labels or --tracks");
  }
  std::vector<std::string> files = a.outputs.maps;
  files.insert(files.end(), {a.outputs.picture, a.outputs.comparison, a.outputs.labelled_map});
  for (const auto& file : files)
  {
    prepareOutput(file, a.force);
  }
}
}  // namespace dyslam
