// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/run/KnownSettings.h>
#include <dyslam/run/RunSlam.h>
#include <dyslam/run/TwoPassRun.h>

#include <algorithm>
#include <iterator>

#include "FirstPass.h"

namespace dyslam
{
namespace
{
/** Results of the first pass that the second one uses. */
struct FirstPassResult
{
  double path_length = 0;             //!< length of the trajectory [m]
  double run_time = 0;                //!< time of the first pass [s]
  std::vector<std::string> warnings;  //!< warnings that are not about the settings
};

/** \throws UserError if labels are given for a run of two passes, which makes them itself. */
void requireNoLabels(const RunRequest& request)
{
  const std::string given =
      labelsIn(readGivenSettings(request.config, request.assignments).merged());
  if (!given.empty())
  {
    throw UserError("dyseg.labels=" + given +
                    ": --passes 2 makes labels of its own in the first pass; give one of the two");
  }
}

/** Chooses the settings of a pass. \param run receives them */
RunSettings chooseFor(const RunRequest& request, SlamRunSettings& run)
{
  const GivenSettings given = readGivenSettings(request.config, request.assignments);
  run.ini = given.path;
  RunSettings chosen = chooseRunSettings(run.rawlog, given);
  setSettings(chosen, run);
  return chosen;
}

/** Warnings of a report that its settings do not have. */
std::vector<std::string> newWarnings(const SlamRunReport& report, const SlamRunSettings& settings)
{
  const std::vector<std::string>& known = settings.warnings;
  std::vector<std::string> warnings;
  std::copy_if(report.warnings.begin(), report.warnings.end(), std::back_inserter(warnings),
               [&known](const std::string& warning)
               { return std::find(known.begin(), known.end(), warning) == known.end(); });
  return warnings;
}

PassesReport runPass(Pass pass,
                     const SlamRunSettings& settings,
                     const RunSettings* chosen,
                     const PassRunner& run)
{
  PassesReport result;
  result.pass = pass;
  result.report = run(pass, settings, chosen);
  result.new_warnings = newWarnings(result.report, settings);
  return result;
}

/** Runs the first pass. \throws UserError. */
PassesReport runFirst(const RunRequest& request, const PassRunner& run)
{
  requireNoLabels(request);
  const RunRequest first = firstPassOf(request);
  SlamRunSettings settings = first.settings;
  const RunSettings chosen = chooseFor(first, settings);
  requireNotStopped(settings);
  return runPass(Pass::first, settings, &chosen, run);
}

/** Results of the first pass, with its warnings worded for the whole run. */
FirstPassResult resultOf(const PassesReport& first, const SlamRunSettings& settings)
{
  FirstPassResult result;
  result.path_length = first.report.path_length;
  result.run_time = first.report.run_time;
  for (const std::string& warning : first.new_warnings)
  {
    if (warning != first.report.second_pass_advice)  // which follows
    {
      result.warnings.push_back("first pass: " + warning);
      if (settings.warn)
      {
        settings.warn(result.warnings.back());
      }
    }
  }
  return result;
}

PassesReport resumeLast(const RunRequest& request, const PassRunner& run)
{
  SlamRunSettings settings = request.settings;
  settings.config = readGivenSettings(request.config, request.assignments).merged();
  const std::string& folder = settings.output_folder;
  if (request.passes == 2 && !isSecondPass(settingsOfCheckpoint(folder), folder))
  {
    throw UserError("--passes 2: the run to resume has no first pass; leave it out, or start anew");
  }
  return runPass(Pass::resumed, settings, nullptr, run);
}

PassesReport runSecond(const RunRequest& request,
                       const FirstPassResult& first,
                       const PassRunner& run)
{
  SlamRunSettings settings = request.settings;
  const RunSettings chosen = chooseFor(request, settings);
  requireNotStopped(settings, "before the second pass");
  settings.first_pass_time = first.run_time;
  settings.warnings.insert(settings.warnings.end(), first.warnings.begin(), first.warnings.end());
  PassesReport result = runPass(Pass::second, settings, &chosen, run);
  const std::string differ = comparePaths(first.path_length, result.report.path_length);
  if (!differ.empty())
  {
    result.report.warnings.push_back(differ);
    result.new_warnings.push_back(differ);
  }
  return result;
}

PassesReport runPasses(const RunRequest& request, const PassRunner& run)
{
  if (request.resume)
  {
    return resumeLast(request, run);
  }
  requireNoUnfinishedRun(request.settings);
  if (request.passes != 2)
  {
    SlamRunSettings settings = request.settings;
    const RunSettings chosen = chooseFor(request, settings);
    requireNotStopped(settings);
    return runPass(Pass::only, settings, &chosen, run);
  }
  PassesReport first = runFirst(request, run);
  const FirstPassResult kept = resultOf(first, request.settings);
  if (!first.report.failure.empty())
  {
    first.report.failure = "first pass: " + first.report.failure;
    return first;
  }
  const std::string& folder = request.settings.output_folder;
  requireNotStopped(request.settings, "after the first pass, whose results are in " + folder);
  RunRequest second = request;
  second.assignments.push_back("dyseg.labels=" + keepLabelsOfFirstPass(folder));
  return runSecond(second, kept, run);
}
}  // namespace

PassesReport runInPasses(const RunRequest& request, const PassRunner& run)
{
  try
  {
    return runPasses(request, run);
  }
  catch (const UnknownSetting& error)
  {
    throw error.withSectionsOf(defaultSettings());
  }
}

void requireNoUnfinishedRun(const SlamRunSettings& settings)
{
  if (!settings.force && hasCheckpoint(settings.output_folder))
  {
    throw UserError(
        settings.output_folder +
        ": has the checkpoint of an unfinished run; continue it with dyslam --resume, or "
        "start anew with --force");
  }
}
}  // namespace dyslam
