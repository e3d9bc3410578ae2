// SPDX-License-Identifier: BSD-3-Clause
// Runs the pipeline on a rawlog as the arguments say: one pass or two, progress,
// and the result in words.
#pragma once

#include <dyslam/core/Error.h>
#include <dyslam/core/Printable.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "AppMain.h"
#include "FirstPass.h"
#include "Progress.h"
#include "SlamArguments.h"
#include "StopSignals.h"

namespace dyslam
{
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

/** Prints the warnings of a run that were not printed yet. \param about_settings number of those
 * about the settings, the first ones, which were printed at the first scan. \param printed others
 * that were printed. */
inline void printWarnings(const SlamRunReport& report,
                          std::size_t about_settings,
                          const std::vector<std::string>& printed)
{
  for (std::size_t i = about_settings; i < report.warnings.size(); ++i)
  {
    if (std::find(printed.begin(), printed.end(), report.warnings[i]) == printed.end())
    {
      std::printf("warning: %s\n", printable(report.warnings[i]).c_str());
    }
  }
}

/** Prints the result of a run. \param folder of its files */
inline void printResult(const SlamRunReport& report, const std::string& folder)
{
  std::printf("%s\n", report.method.c_str());
  std::printf("%s, %.1f m, %s, %s, %s, %s\n", counted(report.frames, "scan").c_str(),
              report.path_length, counted(report.keyframes, "keyframe").c_str(),
              counted(report.loops, "loop").c_str(),
              counted(report.tracks, "moving object").c_str(),
              counted(report.map_points, "map point").c_str());
  if (report.loops_left_out > 0)
  {
    std::printf("%s left out, as they contradict the others\n",
                counted(report.loops_left_out, "more loop").c_str());
  }
  if (report.georeference)
  {
    std::printf("satellite receiver: %s, %.2f m from the trajectory, %.2f m in height (RMS)\n",
                counted(report.georeference->fixes, "position").c_str(),
                report.georeference->horizontal_rmse, report.georeference->vertical_rmse);
  }
  if (report.unconverged > 0)
  {
    std::printf("%s could not be registered; %s motion is predicted\n",
                counted(report.unconverged, "scan").c_str(),
                report.unconverged == 1 ? "its" : "their");
  }
  std::printf("%.1f ms per scan, all stages added up", report.ms_per_scan);
  if (report.frames > 0 && report.run_time > 0)
  {
    std::printf(
        "; %.1f ms of wall time, as stages run in parallel",
        1e3 * (report.run_time - report.first_pass_time) / static_cast<double>(report.frames));
  }
  std::printf("\n");
  if (report.recording_time > 0)
  {
    std::printf("real-time factor %.2f: %.1f s of recording in %.1f s%s\n", report.realtimeFactor(),
                report.recording_time, report.run_time,
                report.first_pass_time > 0 ? ", both passes" : "");
  }
  std::printf("results in %s: %s\n", folder.c_str(), counted(report.files.size(), "file").c_str());
  if (std::find(report.files.begin(), report.files.end(), "report.html") != report.files.end())
  {
    std::printf("the run in a browser: %s/report.html\n", folder.c_str());
  }
  if (report.has_reference)
  {
    std::printf("errors against the ground truth: dyslam-eval run %s\n", folder.c_str());
  }
}

/** \throws UserError if the folder has the checkpoint of a run that was stopped or killed, unless
 * it may be replaced. */
inline void requireNoUnfinishedRun(const SlamRunSettings& settings)
{
  if (!settings.force && hasCheckpoint(settings.output_folder))
  {
    throw UserError(
        settings.output_folder +
        ": has the checkpoint of an unfinished run; continue it with dyslam --resume, or "
        "start anew with --force");
  }
}

/** Prints what happens after a Ctrl-C, which may take a while. */
inline void printStopping(const SlamArguments& a)
{
  if (!a.quiet())
  {
    std::fprintf(stderr, "%sstopping: the results so far are written; Ctrl-C again ends at once\n",
                 isatty(2) == 1 ? "\r\033[K" : "");
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
  bool is_stopping = false;
  SlamRunReport report = run(a.settings,
                             [&](double fraction, std::size_t frames)
                             {
                               printAtFirstScan(a);
                               progress.update(fraction, frames);
                               if (!is_stopping && a.settings.stop && a.settings.stop())
                               {
                                 is_stopping = true;
                                 printStopping(a);
                               }
                             });
  progress.finish(report.frames);
  return report;
}

/** \throws UserError if the user has stopped the program. */
inline void requireNotStopped(const SlamArguments& a, const std::string& when)
{
  if (a.settings.stop && a.settings.stop())
  {
    throw UserError(a.settings.rawlog + ": stopped " + when);
  }
}

/** Prints a warning during a run, in place of the line of progress, which comes again. */
inline void printWarning(SlamArguments& a, const std::string& warning)
{
  a.printed_warnings.push_back(warning);
  if (!a.quiet())
  {
    std::fprintf(stderr, "%swarning: %s\n", isatty(2) == 1 ? "\r\033[K" : "",
                 printable(warning).c_str());
  }
}

/** Result of the first pass. */
struct FirstPass
{
  double path_length = 0;             //!< [m]
  double run_time = 0;                //!< [s]
  std::vector<std::string> warnings;  //!< beyond those about the settings, which both passes have
};

/** Labels the moving points, for the second pass (dyseg.labels).
 * \throws UserError, and UnusableResult if the labels are not to be trusted. */
inline FirstPass runFirstPass(const std::string& program, SlamArguments& a, const SlamRunner& run)
{
  requireNoLabels(a);
  SlamArguments first = firstPassArguments(a);
  chooseSettings(program, first);
  requireNotStopped(a, "before the first scan");
  const SlamRunReport report = runWithProgress(program + ", first pass", first, run);
  FirstPass result;
  result.path_length = report.path_length;
  result.run_time = report.run_time;
  for (std::size_t i = first.settings.warnings.size(); i < report.warnings.size(); ++i)
  {
    if (report.warnings[i] != report.second_pass_advice)  // which follows
    {
      result.warnings.push_back("first pass: " + report.warnings[i]);
      printWarning(a, result.warnings.back());
    }
  }
  if (!report.failure.empty())
  {
    throw UnusableResult("first pass: " + report.failure);
  }
  requireNotStopped(a, "after the first pass, whose results are in " + a.settings.output_folder);
  a.assignments.push_back("dyseg.labels=" + keepLabelsOfFirstPass(a.settings.output_folder));
  return result;
}

/** A warning if the passes disagree about the length of the path [m], else empty. */
inline std::string comparePaths(double first, double second)
{
  constexpr double max_ratio = 0.1;     // of the longer path
  constexpr double max_difference = 1;  // [m], as of a vehicle that stands
  if (std::abs(first - second) <= std::max(max_difference, max_ratio * std::max(first, second)))
  {
    return "";
  }
  char lengths[100];
  std::snprintf(lengths, sizeof lengths, "%.1f m long, that of the first pass %.1f m", second,
                first);
  return std::string("the path is ") + lengths +
         ": in one of them scans may have been registered to moving objects; check trajectory and "
         "map";
}

/** Runs, shows the progress and prints the result. \throws UserError, UnusableResult. */
inline void runSlamProgram(const std::string& program, SlamArguments& a, const SlamRunner& run)
{
  stopOnSignals();
  a.settings.stop = [] { return stop_asked.load(); };
  a.settings.warn = [&a](const std::string& warning) { printWarning(a, warning); };
  std::optional<FirstPass> first;
  if (a.resume)
  {
    readSettingsToResume(a);
    const std::string& folder = a.settings.output_folder;
    if (a.passes == 2 && !isSecondPass(settingsOfCheckpoint(folder), folder))
    {
      throw UserError(
          "--passes 2: the run to resume has no first pass; leave it out, or start anew");
    }
  }
  else
  {
    requireGiven(a.settings.rawlog);
    requireConverted(a.settings.rawlog);
    requireNoUnfinishedRun(a.settings);
    if (a.passes == 2)
    {
      first = runFirstPass(program, a, run);
    }
    chooseSettings(program, a);
    requireNotStopped(a, first ? "before the second pass" : "before the first scan");
    if (first)
    {
      a.messages.clear();  // those of the first pass
      a.settings.first_pass_time = first->run_time;
      std::vector<std::string>& warnings = a.settings.warnings;
      warnings.insert(warnings.end(), first->warnings.begin(), first->warnings.end());
    }
    else if (std::filesystem::exists(a.settings.output_folder + "/report.json"))
    {
      a.messages.push_back(program + ": replaces the earlier run in " + a.settings.output_folder);
    }
  }
  SlamRunReport report = runWithProgress(program, a, run);
  if (first)
  {
    const std::string differ = comparePaths(first->path_length, report.path_length);
    report.warnings.insert(report.warnings.end(), differ.empty() ? 0U : 1U, differ);
  }
  if (!a.quiet())
  {
    printWarnings(report, a.settings.warnings.size(), a.printed_warnings);
    printResult(report, a.settings.output_folder);
  }
  if (!report.failure.empty())
  {
    throw UnusableResult(report.failure);
  }
}
}  // namespace dyslam
