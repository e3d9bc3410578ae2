// SPDX-License-Identifier: BSD-3-Clause
#include "SlamProgram.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/GrowingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/formats/RecordingOrigin.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/run/TwoPassRun.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "AppMain.h"
#include "Checks.h"
#include "Progress.h"
#include "StopSignals.h"

namespace dyslam
{
namespace
{
/** What is said about a pass at its first scan: sensor and settings, once. */
std::vector<std::string> messagesAbout(const std::string& program,
                                       Pass pass,
                                       const RunSettings* chosen,
                                       const std::string& output)
{
  std::vector<std::string> messages;
  if (chosen == nullptr || pass == Pass::second)
  {
    return messages;
  }
  messages.push_back(program + ": " + chosen->sensor.summary() + "; settings: " + chosen->source);
  if (!chosen->missing_times.empty())
  {
    messages.push_back("note: " + chosen->missing_times);
  }
  if (!chosen->levelling_note.empty())
  {
    messages.push_back("note: " + chosen->levelling_note +
                       " (input.level=false keeps the recording's frame)");
  }
  for (const std::string& warning : chosen->warnings)
  {
    messages.push_back("warning: " + warning);
  }
  if (!chosen->start_speed.empty())
  {
    messages.push_back(program + ": the recording begins at about " + chosen->start_speed +
                       " m/s, estimated from the scans that follow (odometry.start_speed)");
  }
  if (pass == Pass::only &&
      std::filesystem::exists(std::filesystem::path(output) / run_files::report))
  {
    messages.push_back(program + ": replaces the earlier run in " + output);
  }
  return messages;
}

/** Prints lines on stderr, once. */
void printOnce(std::vector<std::string>& lines, bool quiet)
{
  for (const std::string& line : lines)
  {
    if (!quiet)
    {
      std::fprintf(stderr, "%s\n", printable(line).c_str());
    }
  }
  lines.clear();
}

/** Prints the warnings of a run, but for those that were printed during the run. */
void printWarnings(const std::vector<std::string>& warnings,
                   const std::vector<std::string>& printed)
{
  for (const std::string& warning : warnings)
  {
    if (std::find(printed.begin(), printed.end(), warning) == printed.end())
    {
      std::printf("warning: %s\n", printable(warning).c_str());
    }
  }
}

/** "25 moving objects (29 tracks in tracks.csv)": the table also has objects that never move. */
std::string objectsInWords(const SlamRunReport& report)
{
  const bool has_table = std::find(report.files.begin(), report.files.end(),
                                   run_files::track_table) != report.files.end();
  const std::string tracks =
      has_table && report.reported_tracks != report.tracks
          ? " (" + counted(report.reported_tracks, "track") + " in " + run_files::track_table + ")"
          : "";
  return counted(report.tracks, "moving object") + tracks;
}

/** Prints what the run found: sizes, loops, satellite positions, the vertical. */
void printFindings(const SlamRunReport& report)
{
  std::printf("methods: %s\n", report.method.c_str());
  std::printf("%s, %.1f m, %s, %s, %s, %s\n", counted(report.frames, "scan").c_str(),
              report.path_length, counted(report.keyframes, "keyframe").c_str(),
              counted(report.loops, "loop").c_str(), objectsInWords(report).c_str(),
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
  if (report.gravity)
  {
    const Gravity& gravity = *report.gravity;
    std::printf("accelerometer: z of the map %s %.1f deg from the vertical (sigma %.1f deg)%s\n",
                gravity.levelled ? "was" : "is", gravity.tilt / radians_per_degree,
                gravity.tilt_sigma / radians_per_degree,
                gravity.levelled ? "; the map was levelled" : "");
  }
  if (report.prior_map && report.prior_map->localised)
  {
    const PriorMapFit& fit = *report.prior_map;
    const std::string again =
        fit.found_again > 0 ? "; lost and found again " + counted(fit.found_again, "time") : "";
    std::printf("prior map: localised after %.1f m; %zu of %s registered, %.3f m RMSE%s\n",
                fit.path_length, fit.registered, counted(fit.tried, "keyframe").c_str(), fit.rmse,
                again.c_str());
  }
  if (report.unconverged > 0)
  {
    std::printf("%s could not be registered; %s motion is predicted\n",
                counted(report.unconverged, "scan").c_str(),
                report.unconverged == 1 ? "its" : "their");
  }
}

/** Prints the time per scan, and how it compares with the recording's. */
void printTimes(const SlamRunReport& report)
{
  std::printf("%.1f ms per scan, all stages added up", report.ms_per_scan);
  if (report.frames > 0 && report.run_time > 0)
  {
    std::printf(
        ", some in parallel; %.1f ms of wall time",
        1e3 * (report.run_time - report.first_pass_time) / static_cast<double>(report.frames));
  }
  std::printf("\n");
  if (report.recording_time > 0)
  {
    std::printf("real-time factor %.2f: %.1f s of recording in %.1f s%s\n", report.realtimeFactor(),
                report.recording_time, report.run_time,
                report.first_pass_time > 0 ? ", both passes" : "");
  }
}

/** Prints where the results are. \param folder of the files of the run */
void printFiles(const SlamRunReport& report, const std::string& folder)
{
  std::printf("results in %s: %s\n", folder.c_str(), counted(report.files.size(), "file").c_str());
  if (std::find(report.files.begin(), report.files.end(), run_files::page) != report.files.end())
  {
    std::printf("the run in a browser: %s/report.html\n", folder.c_str());
  }
  if (report.has_reference)
  {
    std::printf("errors against the ground truth: dyslam-eval run %s\n", shellWord(folder).c_str());
  }
}

/** Prints what happens after a Ctrl-C, which may take a while. */
void printStopping(bool quiet)
{
  if (!quiet)
  {
    printAbove("stopping: the results so far are written; Ctrl-C again ends at once");
  }
}

/** Prints a warning during a run, in place of the line of progress, which comes again. */
void printWarning(const std::string& warning, bool quiet)
{
  if (!quiet)
  {
    printAbove("warning: " + warning);
  }
}

/** Runs a pass and shows the progress. \param title of the line of progress
 * \param messages printed at the first scan \param lag SlamArguments::lag \throws UserError. */
SlamRunReport runWithProgress(Pass pass,
                              const std::string& title,
                              const SlamRunSettings& settings,
                              std::vector<std::string> messages,
                              bool quiet,
                              const std::function<std::string()>& lag,
                              const SlamRunner& run)
{
  constexpr double unknown = -1;
  Progress progress(title, "scans", quiet);
  bool is_stopping = false;
  bool is_behind_others = pass == Pass::resumed;
  SlamRunSettings told = settings;
  told.after_scans = [&progress](const std::string& work) { progress.note(work); };
  SlamRunReport report = run(told,
                             [&](double fraction, std::size_t frames)
                             {
                               printOnce(messages, quiet);
                               if (std::exchange(is_behind_others, false))
                               {
                                 progress.beginBehind({fraction, frames - 1});
                               }
                               const std::string behind = lag ? lag() : "";
                               progress.update(behind.empty() ? fraction : unknown, frames, behind);
                               if (!is_stopping && settings.stop && settings.stop())
                               {
                                 is_stopping = true;
                                 printStopping(quiet);
                               }
                             });
  progress.finish(report.frames);
  return report;
}
}  // namespace

void repeatConversionWarnings(SlamArguments& a)
{
  const auto origin = a.resume ? std::nullopt : originOfRecording(a.settings.rawlog);
  if (!origin)
  {
    return;
  }
  std::vector<std::string> warnings = origin->warnings;
  if (!origin->part.empty())
  {
    warnings.push_back("only a part was converted (" + origin->part +
                       "); for the whole recording run dyslam on it again");
  }
  for (const std::string& warning : warnings)
  {
    const std::string repeated = "conversion of " + origin->input + ": " + warning;
    a.settings.warnings.push_back(repeated);
    printWarning(repeated, a.quiet());
  }
}

void runSlamProgram(const std::string& program, const SlamArguments& a, const SlamRunner& run)
{
  stopOnSignals();
  const bool quiet = a.quiet();
  std::mutex mutex;  // of printed_warnings: warnings come from any thread
  std::vector<std::string> printed_warnings;
  RunRequest request = static_cast<const RunRequest&>(a);
  request.assignments = assignmentsOf(a);
  request.settings.stop = [] { return stop_asked.load(); };
  request.settings.warn = [&mutex, &printed_warnings, quiet](const std::string& warning)
  {
    const std::lock_guard<std::mutex> lock(mutex);
    printed_warnings.push_back(warning);
    printWarning(warning, quiet);
  };
  if (!a.resume)
  {
    requireGiven(a.settings.rawlog);
    requireConverted(a.settings.rawlog);
    if (!quiet && !a.lag && isGrowing(a.settings.rawlog))
    {
      std::fprintf(stderr, "%s: follows %s, which another program is writing, to its end\n",
                   program.c_str(), printable(a.settings.rawlog).c_str());
    }
  }
  const std::string& output = a.settings.output_folder;
  const PassesReport result =
      runInPasses(request,
                  [&](Pass pass, const SlamRunSettings& settings, const RunSettings* chosen)
                  {
                    return runWithProgress(
                        pass, progressTitle(program, pass == Pass::first ? first_pass_part : ""),
                        settings, messagesAbout(program, pass, chosen, output), quiet, a.lag, run);
                  });
  const SlamRunReport& report = result.report;
  if (!quiet && result.pass != Pass::first)
  {
    printWarnings(result.new_warnings, printed_warnings);
    printFindings(report);
    printTimes(report);
    printFiles(report, output);
  }
  if (!report.failure.empty())
  {
    throw UnusableResult(report.failure);
  }
}
}  // namespace dyslam
