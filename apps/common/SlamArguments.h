// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Printable.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/GivenSettings.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/SlamRun.h>
#include <dyslam/pipeline/StartSpeed.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "AppMain.h"
#include "Checks.h"
#include "Progress.h"
#include "StopSignals.h"

namespace dyslam
{
/** Flags of the programs that run the pipeline on a rawlog. */
struct SlamArguments
{
  SlamRunSettings settings;
  std::string config;
  std::vector<std::string> assignments;
  std::string verbosity = "INFO";
  std::optional<int> skip_first_n;
  std::optional<int> only_first_n;
  std::optional<double> start;
  std::optional<double> end;
  bool resume = false;                //!< resume a killed run
  int passes = 1;                     //!< over the recording
  std::future<void> loading;          //!< loadAhead()
  std::vector<std::string> messages;  //!< about sensor and settings, at the first scan

  [[nodiscard]] bool quiet() const { return verbosity == "ERROR"; }
};

/** All but those of input and output. */
inline void declareSlamArguments(CLI::App& app, SlamArguments& a)
{
  app.add_option("-c,--config", a.config,
                 "ini file, or the name of a shipped one (default: the shipped one that fits the "
                 "recording's sensor)");
  app.add_option("--set", a.assignments, "one setting, overrides the ini; repeatable")
      ->type_name("SECTION.KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  app.add_flag("--force", a.settings.force, "also replace files in --output that no run wrote");
  app.add_flag("--labels", a.settings.labels,
               "write labels/NNNNNN.label, moving and static points");
  app.add_flag("--probabilities", a.settings.probabilities,
               "write probabilities/NNNNNN.bin, the moving probability of each point (float32)");
  app.add_flag("--static-scans", a.settings.static_scans,
               "write the scans without moving points: static_scans/NNNNNN.bin and a rawlog");
  app.add_option("--skip-first-n", a.skip_first_n, "scans to skip")->check(notNegative());
  app.add_option("--only-first-n", a.only_first_n, "scans to process after those; 0: all")
      ->check(notNegative());
  app.add_option("--start", a.start, "process scans from this time on [s since the first scan]")
      ->check(notNegative());
  app.add_option("--end", a.end, "process scans before this time [s since the first scan]")
      ->check(positive());
  app.add_option(
         "--passes", a.passes,
         "2: process the recording twice, with segmentation and odometry of the second pass "
         "without the points that the first one labelled moving (dense traffic)")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  app.add_option("--profile", a.settings.profile_csv, "CSV file for the times of every stage");
  app.add_option("-v,--verbosity", a.verbosity, "what is printed")
      ->check(CLI::IsMember({"ERROR", "INFO"}))
      ->capture_default_str();
}

/** Settings of the command line: those of --set, then those with flags of their own. */
inline std::vector<std::string> assignmentsOf(const SlamArguments& a)
{
  std::vector<std::string> assignments = a.assignments;
  const auto add = [&assignments](const std::string& key, const auto& value)
  {
    if (value)
    {
      assignments.push_back(key + "=" + std::to_string(*value));
    }
  };
  add("input.skip_first_n", a.skip_first_n);
  add("input.only_first_n", a.only_first_n);
  add("input.start", a.start);
  add("input.end", a.end);
  return assignments;
}

/** Fills the settings' config: the ini, the settings of the sensor and the command line.
 * \throws UserError. */
inline void chooseSettings(const std::string& program, SlamArguments& a)
{
  const GivenSettings given = readGivenSettings(a.config, assignmentsOf(a));
  if (!given.path.empty())
  {
    a.settings.inputs.push_back(given.path);
  }
  RawlogSourceOptions input;
  load(input, given.merged(), "input");
  const RecordedSensor sensor = recogniseSensor(a.settings.rawlog, input);
  const ChosenSettings chosen = settingsFor(sensor, given);
  Config& config = a.settings.config;
  config = chosen.config;
  a.loading = loadAhead(config);
  a.settings.sensor = sensor.summary();
  a.settings.warnings = chosen.warnings;
  a.messages.push_back(program + ": " + sensor.summary() + "; settings: " + chosen.source);
  if (const std::string missing_times = sensor.missingTimes(config); !missing_times.empty())
  {
    a.settings.sensor += "; " + missing_times;
    a.messages.push_back("note: " + missing_times);
  }
  for (const std::string& warning : a.settings.warnings)
  {
    a.messages.push_back("warning: " + warning);
  }
  if (const auto speed = findStartSpeed(a.settings.rawlog, input, config))
  {
    setStartSpeed(*speed, config);
    a.messages.push_back(program + ": the recording begins at about " +
                         config.section("odometry").at("start_speed").text +
                         " m/s, estimated from the scans that follow (odometry.start_speed)");
  }
}

/** Fills the config with what is given, for a run that is resumed and has all settings.
 * \throws UserError. */
inline void checkSettings(SlamArguments& a)
{
  a.settings.config = readGivenSettings(a.config, assignmentsOf(a)).merged();
}

/** \throws UserError */
inline void requireGiven(const std::string& rawlog)
{
  if (rawlog.empty())
  {
    throw UserError("--input is required; see --help");
  }
}

/** Prints the recognised sensor and the chosen settings on stderr, once. */
inline void printAtFirstScan(SlamArguments& a)
{
  for (const std::string& line : a.messages)
  {
    if (!a.quiet())
    {
      std::fprintf(stderr, "%s\n", printable(line).c_str());
    }
  }
  a.messages.clear();
}

/** \param printed number of the warnings, the first ones, that were printed at the beginning. */
inline void print(const SlamRunReport& report, const std::string& folder, std::size_t printed)
{
  for (std::size_t i = printed; i < report.warnings.size(); ++i)
  {
    std::printf("warning: %s\n", printable(report.warnings[i]).c_str());
  }
  std::printf("%s\n", report.method.c_str());
  std::printf("%s, %.1f m, %s, %s, %s, %s\n", counted(report.frames, "scan").c_str(),
              report.path_length, counted(report.keyframes, "keyframe").c_str(),
              counted(report.loops, "loop").c_str(),
              counted(report.tracks, "moving object").c_str(),
              counted(report.map_points, "map point").c_str());
  if (report.unconverged > 0)
  {
    std::printf("%zu scans could not be registered; their motion is predicted\n",
                report.unconverged);
  }
  std::printf("%.1f ms per scan, all stages added up\n", report.ms_per_scan);
  if (report.recording_time > 0)
  {
    std::printf("real-time factor %.2f: %.1f s of recording in %.1f s\n", report.realtimeFactor(),
                report.recording_time, report.run_time);
  }
  std::printf("results in %s:", folder.c_str());
  for (const auto& file : report.files)
  {
    std::printf(" %s", file.c_str());
  }
  std::printf("\n");
  if (report.has_reference)
  {
    std::printf("errors against the ground truth: dyslam-eval run %s\n", folder.c_str());
  }
}

/** Where the labels of the first of two passes are kept. */
inline std::filesystem::path firstPassLabels(const std::string& output)
{
  return std::filesystem::path(output) / "first_pass" / "labels";
}

/** Moves the labels of a finished run to where the next run in the same folder leaves them.
 * \throws UserError. */
inline void keepLabels(const std::string& output)
{
  namespace fs = std::filesystem;
  const fs::path kept = firstPassLabels(output);
  std::error_code error;
  fs::create_directories(kept.parent_path(), error);
  if (!error && !fs::is_symlink(kept))
  {
    fs::remove_all(kept, error);
  }
  if (!error)
  {
    fs::rename(fs::path(output) / "labels", kept, error);
  }
  if (error)
  {
    throw UserError(kept.string() + ": cannot be written (" + error.message() +
                    "); choose another --output");
  }
}

using SlamRunner = std::function<SlamRunReport(
    const SlamRunSettings& settings, const std::function<void(double, std::size_t)>& on_frame)>;

/** Runs and shows the progress. \throws UserError. */
inline SlamRunReport runWithProgress(const std::string& title,
                                     SlamArguments& a,
                                     const SlamRunner& run)
{
  Progress progress(title, "scans", a.quiet());
  SlamRunReport report = run(a.settings,
                             [&](double fraction, std::size_t frames)
                             {
                               printAtFirstScan(a);
                               progress.update(fraction, frames);
                             });
  progress.finish(report.frames);
  return report;
}

/** Labels the moving points, for the second pass (dyseg.labels). \throws UserError. */
inline void runFirstPass(const std::string& program, SlamArguments& a, const SlamRunner& run)
{
  SlamArguments first;
  first.settings = a.settings;
  first.settings.labels = true;
  first.settings.probabilities = false;
  first.settings.static_scans = false;
  first.settings.profile_csv.clear();
  first.config = a.config;
  first.assignments = assignmentsOf(a);
  first.verbosity = a.verbosity;
  for (const char* unused :
       {"pipeline.mapping", "pipeline.hindsight_tracking", "output.replay", "output.simplemap",
        "output.pcd", "output.ply", "output.scene", "output.plot", "output.page"})
  {
    first.assignments.push_back(std::string(unused) + "=false");
  }
  first.assignments.emplace_back("output.checkpoint_seconds=0");
  chooseSettings(program, first);
  runWithProgress(program + ", first pass", first, run);
  keepLabels(a.settings.output_folder);
  a.assignments.push_back("dyseg.labels=" + firstPassLabels(a.settings.output_folder).string());
}

/** Runs, shows the progress and prints the result. \throws UserError, UselessResult. */
inline void runSlamProgram(const std::string& program, SlamArguments& a, const SlamRunner& run)
{
  stopOnSignals();
  a.settings.stop = [] { return stop_asked.load(); };
  if (a.resume)
  {
    checkSettings(a);
  }
  else
  {
    requireGiven(a.settings.rawlog);
    requireConverted(a.settings.rawlog);
    if (a.passes == 2)
    {
      runFirstPass(program, a, run);
    }
    chooseSettings(program, a);
  }
  if (a.passes == 2)
  {
    a.messages.clear();  // those of the first pass
  }
  const SlamRunReport report = runWithProgress(program, a, run);
  if (!a.quiet())
  {
    print(report, a.settings.output_folder, a.settings.warnings.size());
  }
  if (!report.failure.empty())
  {
    throw UselessResult(report.failure);
  }
}
}  // namespace dyslam
