// SPDX-License-Identifier: BSD-3-Clause
// Runs the pipeline on a rawlog as the arguments say: one pass or two, progress,
// and the result in words.
#pragma once

#include <dyslam/core/Error.h>
#include <dyslam/core/Printable.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "AppMain.h"
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

/** Removes the label files of an earlier first pass, and nothing else. */
inline void removeLabels(const std::filesystem::path& folder)
{
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
  {
    if (entry.path().extension() == ".label")
    {
      files.push_back(entry.path());
    }
  }
  for (const auto& file : files)
  {
    std::filesystem::remove(file);
  }
}

/** Moves the labels of a finished run to where the next run in the same folder leaves them.
 * \throws UserError. */
inline void keepLabels(const std::string& output)
{
  namespace fs = std::filesystem;
  const fs::path kept = firstPassLabels(output);
  const fs::path made = fs::path(output) / "labels";
  try
  {
    for (const fs::path& folder : {kept.parent_path(), kept})
    {
      if (fs::is_symlink(folder))
      {
        throw UserError(folder.string() + ": is a link; remove it, or choose another --output");
      }
    }
    fs::create_directories(kept);
    removeLabels(kept);
    for (const auto& entry : fs::directory_iterator(made))
    {
      fs::rename(entry.path(), kept / entry.path().filename());
    }
    fs::remove(made);
  }
  catch (const fs::filesystem_error& error)
  {
    throw UserError(kept.string() + ": cannot be written (" + error.code().message() +
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

/** Runs, shows the progress and prints the result. \throws UserError, UnusableResult. */
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
    throw UnusableResult(report.failure);
  }
}
}  // namespace dyslam
