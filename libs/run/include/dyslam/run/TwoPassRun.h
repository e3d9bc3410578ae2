// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/run/RunSettings.h>
#include <dyslam/run/SlamRunReport.h>
#include <dyslam/run/SlamRunSettings.h>

#include <functional>
#include <string>
#include <vector>

namespace dyslam
{
/** A user's request for a run on a rawlog in one or two passes. */
struct RunRequest
{
  SlamRunSettings settings;              //!< without those that setSettings() sets
  std::string config;                    //!< ini, as for readGivenSettings()
  std::vector<std::string> assignments;  //!< "section.key=value", as for readGivenSettings()
  bool resume = false;                   //!< resume a run that was stopped or killed
  int passes = 1;                        //!< number of passes over the recording: 1 or 2
};

enum class Pass
{
  only,
  first,   //!< first of two passes: labels the moving points
  second,  //!< second of two passes: without these points
  resumed  //!< the rest of the only pass, or of the second one
};

/** Runs one pass. \param settings settings with the config \param chosen how the config was chosen;
 * null for a resumed run, whose settings are those of its checkpoint */
using PassRunner = std::function<SlamRunReport(
    Pass pass, const SlamRunSettings& settings, const RunSettings* chosen)>;

struct PassesReport
{
  Pass pass = Pass::only;  //!< last pass that was run; `first` if the first one failed
  SlamRunReport report;    //!< report of that pass
  /** Warnings of the report that were not known before that pass. */
  std::vector<std::string> new_warnings;
};

/** Chooses the settings of each pass and runs it.
 *
 * The labels of the first of two passes are moved to `first_pass/labels` in the output folder and
 * read by the second pass (`dyseg.labels`), whose warnings include those of the first. Warnings of
 * the first pass are also passed to `warn` of the settings at its end.
 * \throws UserError for bad settings, for an unfinished run in the output folder that is neither
 *   resumed nor replaced, if `stop` of the settings is true between the passes, and errors of
 *   `run`. */
[[nodiscard]] PassesReport runInPasses(const RunRequest& request, const PassRunner& run);

/** \throws UserError if the output folder has the checkpoint of a stopped or killed run, unless it
 * may be replaced (`force`). */
void requireNoUnfinishedRun(const SlamRunSettings& settings);
}  // namespace dyslam
