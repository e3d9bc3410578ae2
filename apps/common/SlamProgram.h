// SPDX-License-Identifier: BSD-3-Clause
// Runs the pipeline on a rawlog as the arguments say: one pass or two, progress,
// and the result in words.
#pragma once

#include <dyslam/core/Error.h>
#include <dyslam/core/Printable.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>

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

/** Labels the moving points, for the second pass (dyseg.labels). \throws UserError. */
inline void runFirstPass(const std::string& program, SlamArguments& a, const SlamRunner& run)
{
  SlamArguments first = firstPassArguments(a);
  chooseSettings(program, first);
  runWithProgress(program + ", first pass", first, run);
  a.assignments.push_back("dyseg.labels=" + keepLabelsOfFirstPass(a.settings.output_folder));
}

/** Runs, shows the progress and prints the result. \throws UserError, UnusableResult. */
inline void runSlamProgram(const std::string& program, SlamArguments& a, const SlamRunner& run)
{
  stopOnSignals();
  a.settings.stop = [] { return stop_asked.load(); };
  if (a.resume)
  {
    checkSettings(a);
    if (a.passes == 2 && !hasLabelsOfFirstPass(a.settings.output_folder))
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
      runFirstPass(program, a, run);
    }
    chooseSettings(program, a);
    if (a.passes == 2)
    {
      a.messages.clear();  // those of the first pass
    }
    else if (std::filesystem::exists(a.settings.output_folder + "/report.json"))
    {
      a.messages.push_back(program + ": replaces the earlier run in " + a.settings.output_folder);
    }
  }
  const SlamRunReport report = runWithProgress(program, a, run);
  if (!a.quiet())
  {
    print(report, a.settings.output_folder, a.settings.warnings.size());
  }
  if (!report.failure.empty())
  {
    throw UnusableResult(report.failure);
  }
}
}  // namespace dyslam
