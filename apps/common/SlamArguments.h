// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/GivenSettings.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/SlamRun.h>
#include <dyslam/pipeline/StartSpeed.h>

#include <CLI/CLI.hpp>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "Checks.h"
#include "OutputOptions.h"

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
  bool resume = false;                //!< resume a run that was stopped or killed
  int passes = 1;                     //!< over the recording
  std::future<void> loading;          //!< loadAhead()
  std::vector<std::string> messages;  //!< about sensor and settings, printed at the first scan
  std::vector<std::string> printed_warnings;  //!< those that were printed during the run

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
         "without the points that the first one labelled moving (dense traffic); --resume goes on "
         "with the second pass, a run stopped or killed in the first one starts anew")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  addOutputFile(app, "--profile", a.settings.profile_csv, "CSV file for the times of every stage");
  app.add_flag_callback(
      "-q,--quiet", [&a] { a.verbosity = "ERROR"; }, "print errors only, as --verbosity ERROR");
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
  if (!chosen.levelling_note.empty())
  {
    a.settings.sensor += "; " + chosen.levelling_note;
    a.messages.push_back("note: " + chosen.levelling_note +
                         " (input.level=false keeps the recording's frame)");
  }
  for (const std::string& warning : a.settings.warnings)
  {
    a.messages.push_back("warning: " + warning);
  }
  load(input, config, "input");
  if (const auto speed = findStartSpeed(a.settings.rawlog, input, config))
  {
    setStartSpeed(*speed, config);
    a.messages.push_back(program + ": the recording begins at about " +
                         config.section("odometry").at("start_speed").text +
                         " m/s, estimated from the scans that follow (odometry.start_speed)");
  }
}

/** Fills the config with the settings that are given, for a run that is resumed: its checkpoint has
 * all of them. \throws UserError. */
inline void readSettingsToResume(SlamArguments& a)
{
  a.settings.config = readGivenSettings(a.config, assignmentsOf(a)).merged();
}

/** \throws UserError if no recording is given. */
inline void requireGiven(const std::string& rawlog)
{
  if (rawlog.empty())
  {
    throw UserError("--input is required; see --help");
  }
}
}  // namespace dyslam
