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

/** \param printed number of the warnings, the first ones, that were printed at the beginning.
 * \param told others that were printed. */
inline void print(const SlamRunReport& report,
                  const std::string& folder,
                  std::size_t printed,
                  const std::vector<std::string>& told)
{
  for (std::size_t i = printed; i < report.warnings.size(); ++i)
  {
    if (std::find(told.begin(), told.end(), report.warnings[i]) == told.end())
    {
      std::printf("warning: %s\n", printable(report.warnings[i]).c_str());
    }
  }
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
  if (report.unconverged > 0)
  {
    std::printf("%zu scans could not be registered; their motion is predicted\n",
                report.unconverged);
  }
  std::printf("%.1f ms per scan, all stages added up", report.ms_per_scan);
  if (report.frames > 0 && report.run_time > 0)
  {
    std::printf("; %.1f ms of wall time, as stages run in parallel",
                1e3 * report.run_time / static_cast<double>(report.frames));
  }
  std::printf("\n");
  if (report.recording_time > 0)
  {
    std::printf("real-time factor %.2f: %.1f s of recording in %.1f s\n", report.realtimeFactor(),
                report.recording_time, report.run_time);
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

/** \throws UserError if the folder has the checkpoint of a killed run, unless it may be replaced.
 */
inline void requireNoKilledRun(const SlamRunSettings& settings)
{
  if (!settings.force && hasCheckpoint(settings.output_folder))
  {
    throw UserError(settings.output_folder +
                    ": has the checkpoint of a killed run; continue it with dyslam --resume, or "
                    "start anew with --force");
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

/** \throws UserError if the user has stopped the program. */
inline void requireNotStopped(const SlamArguments& a, const std::string& when)
{
  if (a.settings.stop && a.settings.stop())
  {
    throw UserError(a.settings.rawlog + ": stopped " + when);
  }
}

/** Prints a warning during a run, beside the line of progress. */
inline void tell(SlamArguments& a, const std::string& warning)
{
  a.told.push_back(warning);
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
  for (std::size_t i = first.settings.warnings.size(); i < report.warnings.size(); ++i)
  {
    if (report.warnings[i].find("--passes 2") == std::string::npos)  // which this is
    {
      result.warnings.push_back("first pass: " + report.warnings[i]);
      tell(a, result.warnings.back());
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

/** A warning where the passes disagree about the length of the path; empty where they do not. */
inline std::string comparePaths(double first, double second)
{
  constexpr double most = 0.1;  // of the longer path
  constexpr double metres = 1;  // as of a vehicle that stands
  if (std::abs(first - second) <= std::max(metres, most * std::max(first, second)))
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
  a.settings.warn = [&a](const std::string& warning) { tell(a, warning); };
  std::optional<FirstPass> first;
  if (a.resume)
  {
    checkSettings(a);
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
    requireNoKilledRun(a.settings);
    if (a.passes == 2)
    {
      first = runFirstPass(program, a, run);
    }
    chooseSettings(program, a);
    requireNotStopped(a, first ? "before the second pass" : "before the first scan");
    if (first)
    {
      a.messages.clear();  // those of the first pass
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
    print(report, a.settings.output_folder, a.settings.warnings.size(), a.told);
  }
  if (!report.failure.empty())
  {
    throw UnusableResult(report.failure);
  }
}
}  // namespace dyslam
