// SPDX-License-Identifier: BSD-3-Clause
#include "Settings.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/mapbuilder/RunFolder.h>
#include <dyslam/run/GivenSettings.h>
#include <dyslam/run/KnownSettings.h>
#include <dyslam/run/RunSettings.h>
#include <dyslam/run/SlamRun.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
/** A line about the settings, for stderr. */
struct Message
{
  std::string text;
  bool is_warning = false;  //!< printed with --quiet, too
};

/** Sections of an ini: our own, and those of dyslam, which may have written it. */
std::vector<std::string> knownSections()
{
  std::vector<std::string> known = sectionsOfRun();
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
  return (std::filesystem::path(RunArgument(run).folder) / run_files::settings).string();
}

/** The ini of the run that the trajectory is of; empty where it is of none. */
std::string effectiveIniBeside(const std::string& trajectory)
{
  const auto ini = std::filesystem::path(trajectory).parent_path() / run_files::settings;
  return std::filesystem::is_regular_file(ini) ? ini.string() : "";
}

/** The ini of the run that the map is of; empty where it is of none. \throws UserError. */
std::string effectiveIniOf(const Arguments& a)
{
  if (!a.inputs.runs.empty())
  {
    return effectiveIniOfRun(a.inputs.runs.front());
  }
  return a.inputs.run.empty() || !a.given.config.empty()
             ? effectiveIniBeside(a.inputs.recording.trajectory)
             : settingsOfRun(a.inputs.run);
}

/** The assignments of --set that the recording is read with. */
std::vector<std::string> inputAssignments(const Arguments& a)
{
  std::vector<std::string> result;
  std::copy_if(a.given.assignments.begin(), a.given.assignments.end(), std::back_inserter(result),
               [](const std::string& assignment) { return assignment.rfind("input.", 0) == 0; });
  return result;
}

/** The settings under those of --set: of the ini, of the run, or as dyslam chooses them for the
 * sensor. \param messages where they are from */
Config baseSettings(const Arguments& a, std::vector<Message>& messages)
{
  const std::string of_run = effectiveIniOf(a);
  if (!a.inputs.runs.empty())
  {
    Config merged = readGivenSettings(of_run).ini;
    if (!a.given.config.empty())
    {
      merged.merge(readGivenSettings(a.given.config).ini);
    }
    return merged;
  }
  const GivenSettings given =
      readGivenSettings(a.given.config.empty() ? of_run : a.given.config, inputAssignments(a));
  if (a.given.config.empty() && !of_run.empty())
  {
    messages.push_back({"settings: " + of_run});
    return given.ini;
  }
  RecordingSettings chosen = settingsForRecording(a.inputs.recording.rawlog, given);
  messages.push_back({chosen.sensor.summary() + "; settings: " + chosen.source});
  if (!chosen.levelling_note.empty())
  {
    messages.push_back({"note: " + chosen.levelling_note});
  }
  for (const std::string& warning : chosen.warnings)
  {
    messages.push_back({"warning: " + warning, /*is_warning=*/true});
  }
  return std::move(chosen.config);
}

/** The scans.csv of the run that the trajectory is of; empty where it is of none. */
std::string scanTableBeside(const std::string& trajectory)
{
  const auto table = std::filesystem::path(trajectory).parent_path() / run_files::scan_table;
  return !effectiveIniBeside(trajectory).empty() && std::filesystem::is_regular_file(table)
             ? table.string()
             : "";
}

/** Number of the reference system of a run's trajectory in UTM; 0 for other trajectories. */
int referenceSystemOf(const std::string& trajectory)
{
  const std::filesystem::path path(trajectory);
  const auto georeference = path.parent_path() / run_files::georeference;
  return path.filename() == run_files::trajectory_utm &&
                 std::filesystem::is_regular_file(georeference)
             ? readGeoreference(georeference.string()).epsg
             : 0;
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
                    " is in the map frame of its run; give trajectory_utm.txt, --map-pose, or "
                    "--set map_export.epsg=0");
  }
  requireZone(given, of_trajectory);
  return given != 0 ? given : of_trajectory;
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
  const std::string owner = programOfSection(section);
  return owner.empty() ? "" : "; the section [" + section + "] belongs to " + owner;
}

/** \param assigned sections of --set \throws UnknownSetting for one that --set may not change. */
void requireOwnSections(const Config& assigned, const Arguments& a)
{
  const bool merging = !a.inputs.runs.empty();
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
    if (section == "backend" && key == "keyframe_distance")
    {
      throw UserError(value.origin + "=" + value.text + ": give --keyframe-distance " + value.text);
    }
    throw UnknownSetting(value.origin + "=" + value.text + ": dyslam-map has the sections " +
                             names + (merging ? " (--merge)" : ""),
                         ownerOf(section, merging), {"", key, value});
  }
}

/** Settings with which a single recording is read. */
void loadRecording(ConfigLoader& loader, Arguments& a)
{
  a.inputs.recording.scans.scan_table = scanTableBeside(a.inputs.recording.trajectory);
  a.inputs.recording.scans.preprocess = loader.get<PreprocessOptions>("preprocess");
  RawlogSourceOptions& source = a.inputs.recording.source;
  source = loader.get<RawlogSourceOptions>("input");
  a.inputs.range.applyTo(source);
}

/** Settings with which runs are merged. \param messages gets notes about them */
void loadMerger(ConfigLoader& loader, Arguments& a, std::vector<Message>& messages)
{
  a.merger.loops = loader.get<LoopCloserOptions>("loop");
  if (!a.merger.loops.appearance)
  {
    a.merger.loops.appearance = true;  // as RunMerger does
    messages.push_back(
        {"note: loop.appearance=false is for single runs: nothing but appearance shows where the "
         "merged ones meet (limits: loop.appearance_...)"});
  }
  a.merger.solver = loader.get<FactorGraphOptions>("solver");
  a.merger.merge = loader.get<RunMergerOptions>("merge");
  a.builder.hindsight.hindsight = true;  // as mergeMaps() does
}

/** Settings with which the map is built. \param messages gets notes about them */
void loadSections(ConfigLoader& loader, Arguments& a, std::vector<Message>& messages)
{
  a.builder.map = loader.get<StaticMapOptions>("map");
  a.builder.hindsight = loader.get<HindsightOptions>("labels");
  if (a.inputs.runs.empty())
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
  std::vector<Message> ignored;
  loadSections(loader, a, ignored);
  return loader.effective();
}

/** The settings given by ini, run, sensor and --set. \param messages where they are from
 * \throws UserError. */
Config givenSettings(const Arguments& a, std::vector<Message>& messages)
{
  Config config = baseSettings(a, messages);
  Config assigned;
  for (const auto& assignment : a.given.assignments)
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
  if (a.inputs.runs.empty())
  {
    save(a.inputs.recording.source, effective, "input");
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

void loadConfig(Arguments& a)
{
  std::vector<Message> messages;
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
  a.outputs.exports.full_resolution = a.outputs.exports.full_resolution || a.given.full;
  if (!a.outputs.T_fixed_map)  // else the number is that of a frame which only the user knows
  {
    a.outputs.exports.epsg = referenceSystem(a.outputs.exports.epsg, a.inputs.recording.trajectory);
  }
  a.builder.keyframe_distance =
      a.given.keyframe_distance ? *a.given.keyframe_distance : keyframeDistance(config);
  a.outputs.settings = effectiveSettings(loaded, a);
  for (const Message& message : messages)
  {
    if (!a.quiet || message.is_warning)
    {
      std::fprintf(stderr, "%s\n", printable(message.text).c_str());
    }
  }
}
}  // namespace dyslam
